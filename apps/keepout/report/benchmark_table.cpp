// SPDX-License-Identifier: BSD-3-Clause
#include "report/benchmark_table.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <map>
#include <ostream>
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
                                   {cost(row.build_cores)},
                                   {cost(row.bytes_per_triangle)},
                                   {grouped(row.queries)},
                                   {count(row.candidates_mean)},
                                   {count(row.hits_mean)},
                                   {count(100.0 * row.reaching_share)},
                                   {count(row.planes_mean)},
                                   {count(100.0 * row.unsolved_share)},
                                   {count(100.0 * row.worse_share)},
                                   {median_or_dash(row.collect)},
                                   {median_or_dash(row.query)},
                                   {median_or_dash(row.step_query)},
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

/// A row's hash over as many steps as another made too, or a power of two fewer.
std::uint64_t hash_over(const BenchmarkRow& row, std::size_t steps) {
  return row.queries == steps ? row.hash : row.first_hashes[std::bit_width(steps) - 1];
}

/// Whether rows that differ in the index alone led to the same steps, as far as they made the same;
/// and which rows have no such other.
std::string same_steps(const Benchmark& benchmark) {
  using Problem =
      std::tuple<std::string, std::size_t, std::optional<double>, std::string, std::string>;
  std::map<Problem, Rows> groups;
  std::size_t unverified = 0, alone = 0, members = 0, compared = 0, same = 0;
  for (const BenchmarkRow& row : benchmark.rows) {
    if (row.verified && row.queries > 0) {
      groups[{row.mesh, row.triangles, row.radius, row.activation, row.solver}].push_back(&row);
    } else {
      ++unverified;
    }
  }
  std::size_t fewest = std::numeric_limits<std::size_t>::max(), most = 0;
  for (const auto& [problem, rows] : groups) {
    if (rows.size() < 2) {
      ++alone;
      continue;
    }
    const BenchmarkRow& longest = **std::ranges::max_element(rows, {}, &BenchmarkRow::queries);
    bool all = true;
    for (const BenchmarkRow* row : rows) {
      if (row == &longest) continue;
      const std::size_t steps =
          row->queries == longest.queries ? row->queries : std::bit_floor(row->queries);
      fewest = std::min(fewest, steps);
      most = std::max(most, steps);
      all = all && hash_over(*row, steps) == hash_over(longest, steps);
    }
    members += rows.size();
    ++compared;
    same += all ? 1 : 0;
  }
  std::string text;
  if (compared > 0) {
    text = " Rows that differ in the index alone, " + grouped(members) + " in " +
           counted(compared, "group") + ", made the same steps in " + grouped(same) +
           " of them, as far as they were asked for the same, the first " +
           (fewest == most ? grouped(most) : grouped(fewest) + " to " + grouped(most)) +
           " motions.";
  }
  if (compared > 0 && alone > 0) {
    text += " Left out: " + counted(alone, "row") + " without such another.";
  }
  if (unverified > 0) text += " Left out: " + counted(unverified, "row") + " not verified.";
  return text;
}

/// What the names stand for.
void print_parts(std::ostream& out, const Benchmark& benchmark) {
  if (benchmark.parts.empty()) return;
  out << "<dl>";
  for (const auto& [name, what] : benchmark.parts) {
    out << "<dt>" << escape(name) << "</dt><dd>" << escape(what) << "</dd>";
  }
  out << "</dl>";
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
                   "cores busy",
                   "bytes a triangle",
                   "queries",
                   "candi\u00addates",
                   "hits",
                   "reach any [%]",
                   "planes",
                   "not solved [%]",
                   "worse [%]",
                   "candidates only [µs]",
                   "query [µs]",
                   "find [µs]",
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
         "same steps, bit for bit."
      << same_steps(benchmark) << "</p>\n";
  print_table(out, table);
  out << "</section>\n";
}

void print_machine_section(std::ostream& out, const Benchmark& benchmark) {
  if (benchmark.rows.empty()) return;
  out << "<h2>The machine, and how it was measured</h2>\n"
      << "<div class=\"panels wide\" style=\"--columns:2\">\n<figure>";
  print_machine_facts(out, benchmark.machine, benchmark.date, benchmark.command, benchmark.seed);
  print_parts(out, benchmark);
  out << "</figure>\n<div>\n<p class=\"method\">All combinations draw on the same seeded "
         "motions; a slow one is asked the first of them only, and the table says how many: rows "
         "of few queries compare by their order of magnitude. Each is a MotionConstraint as users "
         "make one, but takes its tips as they are: to place a tip that no step led to is not part "
         "of it. It is asked twice for the same motions, stage by stage and as a whole, and only "
         "what was right both times has times. Steps with active_set are held, bit for bit, to "
         "those of pd_tree with active_set and the plain form of the rule, which are held to brute "
         "force in a sample of eight places for each rule and radius; those of other solvers "
         "within the solver's stated accuracy. Under the rule certified another solver's motion "
         "counts as right because the rule has proven it; the column <b>worse</b> tells how many "
         "fell short of the reference by more than a thousandth of the motion. The triangles of "
         "every query are held, bit for bit, to those of pd_tree, and to brute force in the same "
         "sample. Rows with more than 1 % of the steps without an answer are in the table, but not "
         "ranked, nor are those that <b>reach any</b> triangle in fewer than half of the "
         "motions.</p>\n"
         "<p class=\"method\"><b>Candidates only</b> is what the index proposes; <b>query</b> is "
         "that, the exact test of each candidate, the closest point of each hit, and their "
         "sorting: "
         "the same work for every index, around the same places, apart from the step. <b>Find</b> "
         "is the query as it is part of the step; it is empty where the rule searches the tree by "
         "itself. <b>Activate</b> makes planes of the triangles; <b>solve</b> searches for the "
         "motion: the solver's work and, under certified, the rule's proofs; <b>step</b> is all of "
         "it, one call, timed in a round of its own, so that the medians of stages need not add up "
         "to its median. <b>Planes</b> are those the solver was given in the end. Loading the mesh "
         "and building the index are not part of it.";
  if (has_nlopt(benchmark)) {
    out << " NLopt's times include posing the problem without units and proving the answer.";
  }
  out << "</p>\n"
         "<p class=\"method\">Percentiles are by nearest rank: times that did occur. The 99 % "
         "needs 100 samples, the 99.9 % a thousand. The slowest step includes whatever else the "
         "machine did meanwhile.";
  if (benchmark.machine.clock_ns > 0.0) {
    out << " Reading the clock adds " << rounded(benchmark.machine.clock_ns)
        << " ns to each time, which is not taken off.";
  }
  out << "</p>\n<p class=\"method\">Neither times nor their ratios carry over to another "
         "machine or another SIMD target: measure there.</p>\n</div>\n</div>\n";
}

}  // namespace keepout::app
