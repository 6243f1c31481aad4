// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

#include "bench/benchmark.h"

namespace keepout::app {

/// What is printed for a terminal: where it ran and what the columns mean; line by line as the rows
/// come in; and what was found in the end.
void print_machine(std::ostream& out, const Machine& machine);
void print_table_head(std::ostream& out);
void print_table_row(std::ostream& out, const BenchmarkRow& row);
void print_verdict(std::ostream& out, const Benchmark& benchmark);

}  // namespace keepout::app
