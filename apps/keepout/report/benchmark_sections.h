// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

#include "bench/benchmark.h"

namespace keepout::app {

/// The sections of a benchmark that show pictures, each with a sentence that says what to see in
/// them. A section for which nothing was timed is left out.

void print_query_section(std::ostream& out, const Benchmark& benchmark);
void print_rate_section(std::ostream& out, const Benchmark& benchmark);
void print_solve_section(std::ostream& out, const Benchmark& benchmark);
void print_stage_section(std::ostream& out, const Benchmark& benchmark);
void print_cost_section(std::ostream& out, const Benchmark& benchmark);

}  // namespace keepout::app
