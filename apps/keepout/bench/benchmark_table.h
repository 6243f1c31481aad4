// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdio>
#include <iosfwd>
#include <string>

#include "bench/benchmark.h"

namespace keepout::app {

/// By the rules of printf, for a line of a table.
template <class... Values>
std::string formatted(const char* format, Values... values) {
  std::array<char, 320> text;
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

/// What is printed for a terminal: where it ran and what the columns mean; line by line as the rows
/// come in; and what was found in the end.
void print_machine(std::ostream& out, const Machine& machine);
void print_table_head(std::ostream& out);
void print_table_row(std::ostream& out, const BenchmarkRow& row);
void print_verdict(std::ostream& out, const Benchmark& benchmark);

/// All of it: {"machine": {...}, "rows": [{"mesh": ..., "query_us": {"p50": ..., ...}, ...}, ...]}.
/// null stands for what was not measured; a radius of null is as far as the motions lead.
void write_json(std::ostream& out, const Benchmark& benchmark);

/// The rows, one a line, below a line of names; what was not measured is empty. Each says where it
/// was measured, so that files can be put together.
void write_csv(std::ostream& out, const Benchmark& benchmark);

}  // namespace keepout::app
