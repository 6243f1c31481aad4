// SPDX-License-Identifier: BSD-3-Clause
#include "report/benchmark_report.h"

#include <ostream>
#include <string>

#include "report/agreement_sections.h"
#include "report/benchmark_sections.h"
#include "report/benchmark_style.h"
#include "report/benchmark_table.h"
#include "report/benchmark_verdict.h"
#include "report/page.h"
#include "report/text.h"

namespace keepout::app {
namespace {

bool empty(const Comparison& comparison) {
  return comparison.indices.empty() && comparison.solvers.empty() &&
         comparison.narrow_phases.empty();
}

std::string title_of(const Benchmark& benchmark, const Comparison& comparison) {
  if (!benchmark.rows.empty()) return headline(benchmark);
  return empty(comparison) ? "Nothing was measured." : agreement_headline(comparison);
}

/// Speed first, then correctness, then everything on which they rest.
void print_sections(std::ostream& out, const Benchmark& benchmark, const Comparison& comparison) {
  print_query_section(out, benchmark);
  print_rate_section(out, benchmark);
  print_solve_section(out, benchmark);
  print_stage_section(out, benchmark);
  print_cost_section(out, benchmark);
  print_index_agreement(out, comparison);
  print_solver_agreement(out, comparison);
  print_narrow_phase_agreement(out, comparison);
  print_row_section(out, benchmark);
  print_machine_section(out, benchmark);
}

void print_account(std::ostream& out, const Benchmark& benchmark) {
  const std::string text = account(benchmark);
  if (!text.empty()) out << "<p class=\"account\">" << escape(text) << "</p>\n";
}

}  // namespace

void print_benchmark_report(std::ostream& out, const Benchmark& benchmark,
                            const Comparison& comparison) {
  open_page(out, "keepout bench", benchmark_style);
  out << "<p class=\"eyebrow\">Search trees, activation rules and solvers, on the same motions";
  if (!benchmark.machine.processor.empty()) {
    out << "; <strong>" << escape(benchmark.machine.processor) << "</strong>, "
        << escape(benchmark.machine.simd);
  }
  if (!benchmark.date.empty()) out << ", " << escape(benchmark.date);
  out << "</p>\n<h1>" << escape(title_of(benchmark, comparison)) << "</h1>\n";
  print_account(out, benchmark);
  print_sections(out, benchmark, comparison);
  close_page(out);
}

void print_benchmark_sections(std::ostream& out, const Benchmark& benchmark,
                              const Comparison& comparison) {
  if (benchmark.rows.empty() && empty(comparison)) return;
  out << "<h2 class=\"part\">" << escape(title_of(benchmark, comparison)) << "</h2>\n";
  print_account(out, benchmark);
  print_sections(out, benchmark, comparison);
}

}  // namespace keepout::app
