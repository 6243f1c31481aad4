// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

#include "bench/benchmark.h"

namespace keepout::app {

/// The table for a terminal, line by line as the rows come in.
void print_table_head(std::ostream& out);
void print_table_row(std::ostream& out, const BenchmarkRow& row);

}  // namespace keepout::app
