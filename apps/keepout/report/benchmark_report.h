// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

#include "bench/benchmark.h"
#include "compare/comparison.h"

namespace keepout::app {

/// Writes how fast the parts are, and how well they agree, as one HTML page that needs nothing but
/// itself. A record without rows has no sections.
void print_benchmark_report(std::ostream& out, const Benchmark& benchmark,
                            const Comparison& comparison);

/// The same as sections at the end of another page, which must have the style of
/// benchmark_style.h. Nothing, where both records are empty.
void print_benchmark_sections(std::ostream& out, const Benchmark& benchmark,
                              const Comparison& comparison);

}  // namespace keepout::app
