// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "report/benchmark_table.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <map>
#include <ostream>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "number_text.h"
#include "report/benchmark_rows.h"
#include "report/machine_facts.h"
#include "report/table.h"
#include "report/text.h"

namespace keepout::app {
namespace {

std::string hexadecimal(std::uint64_t hash) {
  char text[32];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

std::string median_or_dash(const std::optional<Timing>& timing) {
  return timing ? rounded(timing->p50) : "-";
}

std::string or_dash(const std::optional<double>& value) { return value ? rounded(*value) : "-"; }

/// What was not timed has no counts either, as far as anybody may rely on.
std::vector<TableCell> cells(const BenchmarkRow& row) {
  constexpr auto name = TableCell::Look::name, words = TableCell::Look::words;
  const auto count = [&](double value) { return row.queries > 0 ? mean_text(value) : "-"; };
  const auto cost = [](double value) { return value > 0.0 ? rounded(value) : "-"; };
  std::vector<TableCell> result = {{row.index},
                                   {row.activation, name},
                                   {row.solver, name},
                                   {row.mesh, name},
                                   {grouped(row.triangles)},
                                   {row.radius ? trimmed(*row.radius) : "motion"},
                                   {cost(row.build_s)},
                                   {cost(row.bytes_per_triangle)},
                                   {grouped(row.queries)},
                                   {count(row.candidates_mean)},
                                   {count(row.hits_mean)},
                                   {count(row.planes_mean)},
                                   {count(row.iterations_mean)},
                                   {count(100.0 * row.unsolved_share)},
                                   {count(100.0 * row.worse_share)},
                                   {median_or_dash(row.collect)},
                                   {median_or_dash(row.query)},
                                   {median_or_dash(row.activate)},
                                   {median_or_dash(row.solve)},
                                   {median_or_dash(row.step)}};
  const std::optional<Timing>& step = row.step;
  result.push_back({step ? or_dash(step->p99) : "-"});
  result.push_back({step ? or_dash(step->p999) : "-"});
  result.push_back({step ? rounded(step->max) : "-"});
  result.push_back({row.verified ? hexadecimal(row.hash) : "-"});
  std::string remark = row.remark;
  if (!row.verified && remark.empty()) remark = "not verified";
  result.push_back({remark, words});
  return result;
}

Rows in_order(const Benchmark& benchmark) {
  Rows rows;
  for (const BenchmarkRow& row : benchmark.rows) rows.push_back(&row);
  // By mesh as it came, the largest first; the largest sphere first; then the fastest.
  const std::vector<std::string> meshes = names(rows, &BenchmarkRow::mesh);
  const auto key = [&](const BenchmarkRow& row) {
    return std::tuple(std::find(meshes.begin(), meshes.end(), row.mesh) - meshes.begin(),
                      -static_cast<double>(row.triangles), -row.radius.value_or(0.0),
                      !row.step.has_value(), row.step ? row.step->p50 : 0.0);
  };
  std::stable_sort(rows.begin(), rows.end(),
                   [&](const BenchmarkRow* a, const BenchmarkRow* b) { return key(*a) < key(*b); });
  return rows;
}

/// In how many comparisons of indices, all else being equal, they all led to the same steps.
std::string same_steps(const Benchmark& benchmark) {
  using Problem = std::tuple<std::string, std::size_t, std::optional<double>, std::string,
                             std::string, std::size_t>;
  struct Group {
    std::size_t rows = 0;
    std::set<std::uint64_t> hashes;
  };
  std::map<Problem, Group> groups;
  for (const BenchmarkRow& row : benchmark.rows) {
    if (!row.verified) continue;
    Group& group =
        groups[{row.mesh, row.triangles, row.radius, row.activation, row.solver, row.queries}];
    ++group.rows;
    group.hashes.insert(row.hash);
  }
  std::size_t compared = 0, same = 0;
  for (const auto& [problem, group] : groups) {
    if (group.rows < 2) continue;
    ++compared;
    if (group.hashes.size() == 1) ++same;
  }
  if (compared == 0) return {};
  return ": all indices did in " + grouped(same) + " of the " + counted(compared, "group") +
         " that differ in the index alone";
}

bool has_nlopt(const Benchmark& benchmark) {
  return std::ranges::any_of(
      benchmark.rows, [](const BenchmarkRow& row) { return row.solver.starts_with("nlopt"); });
}

}  // namespace

void print_row_section(std::ostream& out, const Benchmark& benchmark) {
  if (benchmark.rows.empty()) return;
  Table table;
  table.height = Table::Height::windowed;
  table.columns = {"index",
                   "rule",
                   "solver",
                   "mesh",
                   "triangles",
                   "radius [mm]",
                   "build [s]",
                   "bytes a triangle",
                   "queries",
                   "candi\u00addates",
                   "hits",
                   "planes",
                   "itera\u00adtions",
                   "not solved [%]",
                   "worse [%]",
                   "candidates only [µs]",
                   "query [µs]",
                   "activate [µs]",
                   "solve [µs]",
                   "step [µs]",
                   "step 99 % [µs]",
                   "step 99.9 % [µs]",
                   "slowest step [µs]",
                   "hash of all steps",
                   "remark"};
  for (const BenchmarkRow* row : in_order(benchmark)) table.rows.push_back(cells(*row));
  const std::size_t untimed = benchmark.rows.size() - timed(benchmark, &BenchmarkRow::step).size();
  out << "<section class=\"everything\">\n<h2>Every row</h2>\n<p class=\"lead\">"
      << counted(benchmark.rows.size(), "row") << ", "
      << (untimed == 0 ? "all of them timed" : grouped(untimed) + " of them not timed")
      << ": the largest mesh first, then the largest sphere, then the fastest step. Times are "
         "medians unless they say otherwise; counts are means. Rows with the same hash made the "
         "same steps, bit for bit"
      << same_steps(benchmark) << ".</p>\n";
  print_table(out, table);
  out << "</section>\n";
}

void print_machine_section(std::ostream& out, const Benchmark& benchmark) {
  if (benchmark.rows.empty()) return;
  out << "<h2>The machine, and how it was measured</h2>\n"
      << "<div class=\"panels wide\" style=\"--columns:2\">\n<figure>";
  print_machine_facts(out, benchmark.machine, benchmark.date, benchmark.command, benchmark.seed);
  out << "</figure>\n<div>\n<p class=\"method\">All combinations draw on the same seeded "
         "motions; a slow one is asked the first of them only, and the table says how many: rows "
         "of "
         "few queries compare by their order of magnitude. What is wrong is not timed. An index is "
         "held to the triangles of brute force "
         "in a sample of eight places for each rule and radius, and in all its steps, bit for bit, "
         "to those of pd_tree with active_set, which are themselves held to brute force in that "
         "sample. The steps of other solvers are held to them within the solver's stated "
         "accuracy. Under the rule certified another solver's motion counts as right because the "
         "rule has proven it; the column <b>worse</b> tells how many fell short of the reference "
         "by more than a thousandth of the motion. Rows with more than 1 % of the steps without an "
         "answer are in the table, but not ranked.</p>\n"
         "<p class=\"method\"><b>Candidates only</b> is what the index does alone; <b>query</b> "
         "adds "
         "the exact test of each candidate, which all indices share, so that nobody is credited "
         "with it; <b>activate</b> makes planes of the triangles; <b>solve</b> searches for the "
         "motion: the solver's work and, under certified, the rule's proofs; <b>step</b> is all of "
         "it, one call. Loading the mesh and building the index are not part "
         "of it. Stages are timed one by one, so that their medians need not add up to the median "
         "of the step.";
  if (has_nlopt(benchmark)) {
    out << " NLopt's times include posing the problem without units and proving the answer, about "
           "a third of them: without that its answers could not be used.";
  }
  out << "</p>\n"
         "<p class=\"method\">Percentiles are by nearest rank: times that did occur. The 99 % "
         "needs "
         "100 samples, the 99.9 % a thousand. The slowest step tells more of the machine than of "
         "the method.";
  if (benchmark.machine.clock_ns > 0.0) {
    out << " Reading the clock adds " << rounded(benchmark.machine.clock_ns)
        << " ns to each time, which is not taken off.";
  }
  out << "</p>\n<p class=\"method\">Absolute times do not carry over to another machine; ratios "
         "between rows do, by and large.</p>\n</div>\n</div>\n";
}

}  // namespace keepout::app
