// SPDX-License-Identifier: BSD-3-Clause
#include "report/agreement_sections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <vector>

#include "compare/comparison.h"
#include "number_text.h"
#include "report/mark.h"
#include "report/page.h"
#include "report/plot.h"
#include "report/spans.h"
#include "report/table.h"
#include "report/text.h"

namespace keepout::app {
namespace {

constexpr auto to_left = TableCell::Look::name;

/// Errors span many powers of ten.
std::string error_text(double value) {
  if (!std::isfinite(value)) return "?";
  if (value == 0.0) return "0";
  if (value >= 1e-3) return rounded(value, 2);
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  return tick_text(power * std::round(10.0 * value / power) / 10.0);
}

/// What the libraries said, in their words: a line for each solver.
void print_outcomes(std::ostream& out, const std::vector<SolverAgreement>& rows) {
  if (std::all_of(rows.begin(), rows.end(),
                  [](const SolverAgreement& row) { return row.outcomes.empty(); })) {
    return;
  }
  out << "<h3>What the libraries said, and what was found</h3>\n<figure class=\"outcomes\"><dl>";
  for (const SolverAgreement& row : rows) {
    if (row.outcomes.empty()) continue;
    std::vector<std::pair<std::size_t, std::string>> most_first;
    for (const auto& [words, count] : row.outcomes) most_first.emplace_back(count, words);
    std::stable_sort(most_first.begin(), most_first.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    out << "<dt>" << escape(row.solver + ", " + row.activation) << "</dt><dd>";
    const char* separator = "";
    for (const auto& [count, words] : most_first) {
      out << separator << grouped(count) << "\u00a0× " << escape(words);
      separator = "; ";
    }
    out << "</dd>";
  }
  out << "</dl></figure>\n";
}

/// Those of one relation; on the same axis as the others, so that panels can be compared.
std::string error_spans(const std::vector<NarrowPhaseAgreement>& rows,
                        const std::string& relation) {
  Spans chart;
  chart.description = "Median and worst error of each narrow phase, " + relation + ".";
  chart.axis = "error [mm]";
  std::vector<std::string> backends;
  for (const NarrowPhaseAgreement& row : rows) {
    const auto known = std::find(backends.begin(), backends.end(), row.backend);
    const auto number = static_cast<std::size_t>(known - backends.begin());
    if (known == backends.end()) backends.push_back(row.backend);
    chart.in_range.insert(chart.in_range.end(), {row.median_error, row.worst_error});
    if (row.relation != relation) continue;
    Span span{row.backend + ", " + row.tool,
              error_text(row.median_error) + " to " + error_text(row.worst_error),
              series_class(number),
              mark_of(number),
              row.median_error,
              row.worst_error};
    chart.spans.push_back(std::move(span));
  }
  return to_svg(chart);
}

void print_errors(std::ostream& out, const std::vector<NarrowPhaseAgreement>& rows) {
  std::vector<std::string> relations;
  for (const NarrowPhaseAgreement& row : rows) {
    if (std::find(relations.begin(), relations.end(), row.relation) == relations.end()) {
      relations.push_back(row.relation);
    }
  }
  out << "<div class=\"panels charts\" style=\"--columns:"
      << std::min<std::size_t>(relations.size(), 3) << "\">\n";
  for (const std::string& relation : relations) {
    out << "<figure class=\"measured\"><figcaption><span class=\"name\">" << escape(relation)
        << "</span><br><span class=\"about\">A mark at the median error, a line to the worst; no "
           "mark where it is 0.</span></figcaption>"
        << error_spans(rows, relation) << "</figure>\n";
  }
  out << "</div>\n";
}

}  // namespace

std::string agreement_headline(const Comparison& comparison) {
  if (!comparison.indices.empty()) return index_verdict(comparison.indices);
  if (!comparison.solvers.empty()) return solver_verdict(comparison.solvers);
  return narrow_phase_verdict(comparison.narrow_phases);
}

void print_index_agreement(std::ostream& out, const Comparison& comparison) {
  if (comparison.indices.empty()) return;
  Table table;
  table.columns = {"index",
                   "rule",
                   "mesh",
                   "poses",
                   "missed",
                   "invented",
                   "worst error of a closest point [mm]",
                   "worst angle of a plane [rad]",
                   "worst difference of a step [mm]",
                   "steps that differ"};
  for (const IndexAgreement& row : comparison.indices) {
    table.rows.push_back({{row.index},
                          {row.activation, to_left},
                          {row.mesh, to_left},
                          {grouped(row.poses)},
                          harm(row.missed),
                          harm(row.invented),
                          {error_text(row.closest_point_error)},
                          {error_text(row.plane_angle)},
                          {error_text(row.step_difference)},
                          {grouped(row.steps_that_differ)}});
  }
  open_section(out, "Do the indices agree?",
               index_verdict(comparison.indices) + " " +
                   index_agreement_by_construction(comparison.indices));
  print_table(out, table);
}

void print_solver_agreement(std::ostream& out, const Comparison& comparison) {
  if (comparison.solvers.empty()) return;
  Table table;
  table.columns = {"solver",
                   "rule",
                   "problems",
                   "optimal",
                   "infeasible",
                   "gave up",
                   "wrong",
                   "worst difference of a step, relative",
                   "worst KKT residual",
                   "median [µs]",
                   "99 % [µs]"};
  for (const SolverAgreement& row : comparison.solvers) {
    table.rows.push_back({{row.solver},
                          {row.activation, to_left},
                          {grouped(row.problems)},
                          {grouped(row.optimal)},
                          {grouped(row.infeasible)},
                          harm(row.gave_up),
                          harm(row.wrong),
                          {error_text(row.step_difference)},
                          {error_text(row.kkt_residual)},
                          {rounded(row.median_us)},
                          {rounded(row.p99_us)}});
  }
  open_section(out, "Do the solvers agree?", solver_verdict(comparison.solvers));
  print_table(out, table);
  print_outcomes(out, comparison.solvers);
}

void print_narrow_phase_agreement(std::ostream& out, const Comparison& comparison) {
  if (comparison.narrow_phases.empty()) return;
  Table table;
  table.columns = {"narrow phase", "tool",         "relation",          "pairs",
                   "no answer",    "contradicted", "median error [mm]", "worst error [mm]",
                   "median [µs]",  "99 % [µs]"};
  for (const NarrowPhaseAgreement& row : comparison.narrow_phases) {
    table.rows.push_back({{row.backend},
                          {row.tool, to_left},
                          {row.relation, to_left},
                          {grouped(row.pairs)},
                          harm(row.failed),
                          harm(row.contradicted),
                          {error_text(row.median_error)},
                          {error_text(row.worst_error)},
                          {rounded(row.median_us)},
                          {rounded(row.p99_us)}});
  }
  open_section(out, "Do the narrow phases agree?",
               narrow_phase_verdict(comparison.narrow_phases) +
                   " Touching stands for a pair within " + touch_text +
                   " of a touch, on either side.");
  print_table(out, table);
  print_errors(out, comparison.narrow_phases);
}

}  // namespace keepout::app
