// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/benchmark_table.h"

#include <array>
#include <cstdio>
#include <ostream>
#include <string>

#include "number_text.h"
#include "report/benchmark_verdict.h"

namespace keepout::app {
namespace {

template <class... Values>
std::string formatted(const char* format, Values... values) {
  std::array<char, 320> text;
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

std::string time(const std::optional<double>& microseconds) {
  return microseconds ? rounded(*microseconds) : "-";
}

std::string median(const std::optional<Timing>& timing) { return timing ? time(timing->p50) : "-"; }

/// "  1.2 % worse"; nothing where there are none.
std::string share(double value, const char* of_what) {
  return value > 0.0 ? "  " + rounded(100.0 * value, 2) + " % " + of_what : "";
}

}  // namespace

void print_machine(std::ostream& out, const Machine& machine) {
  out << machine.processor << ", " << counted(machine.cores, "core") << ", SIMD target "
      << machine.simd << '\n'
      << "build in s, and the cores that it kept busy; times in us, medians unless said\n"
         "collect, query: what the index proposes, and all triangles where the rule looks; for "
         "every "
         "index the same work, apart from the step\n"
         "find, activate, solve: stages of the step; '-' where the rule searches the tree by "
         "itself\n";
}

void print_verdict(std::ostream& out, const Benchmark& benchmark) {
  for (const auto& [name, remark] : benchmark.remarks) {
    out << '\n' << name << ": " << remark;
  }
  out << '\n' << headline(benchmark) << '\n' << account(benchmark) << '\n';
}

void print_table_head(std::ostream& out) {
  out << formatted(
      "%-6s %-18s %-9s %-12s %6s %5s %6s %7s %7s %7s | %8s %8s | %8s %8s %8s %8s %8s %8s\n", "r mm",
      "index", "rule", "solver", "build", "cores", "B/tri", "cand.", "hits", "planes", "collect",
      "query", "find", "activate", "solve", "step p50", "p99", "p99.9");
}

void print_table_row(std::ostream& out, const BenchmarkRow& row) {
  const std::string radius = row.radius ? trimmed(*row.radius) : "motion";
  out << formatted("%-6s %-18s %-9s %-12s ", radius.c_str(), row.index.c_str(),
                   row.activation.c_str(), row.solver.c_str());
  if (!row.step) {
    out << row.remark << '\n';
    return;
  }
  out << formatted("%6s %5s %6s %7s %7s %7s | %8s %8s | %8s %8s %8s %8s %8s %8s",
                   rounded(row.build_s, 2).c_str(), rounded(row.build_cores, 2).c_str(),
                   rounded(row.bytes_per_triangle).c_str(), rounded(row.candidates_mean, 2).c_str(),
                   rounded(row.hits_mean).c_str(), rounded(row.planes_mean).c_str(),
                   median(row.collect).c_str(), median(row.query).c_str(),
                   median(row.step_query).c_str(), median(row.activate).c_str(),
                   median(row.solve).c_str(), median(row.step).c_str(), time(row.step->p99).c_str(),
                   time(row.step->p999).c_str())
      << share(1.0 - row.reaching_share, "reach nothing")
      << share(row.unsolved_share, "without an answer") << share(row.worse_share, "worse") << '\n';
}

}  // namespace keepout::app
