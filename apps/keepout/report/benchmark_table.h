// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

#include "bench/benchmark.h"

namespace keepout::app {

/// Every row with all its figures, those that were not timed with the reason.
void print_row_section(std::ostream& out, const Benchmark& benchmark);

/// The machine, and how it was measured.
void print_machine_section(std::ostream& out, const Benchmark& benchmark);

}  // namespace keepout::app
