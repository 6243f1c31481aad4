// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bit>
#include <iterator>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "bench/benchmark.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

using Rows = std::vector<const BenchmarkRow*>;  // in their order

/// True if at least half of the queries find a triangle. Otherwise the median is the time of
/// finding nothing.
bool reaches(const BenchmarkRow& row) { return row.reaching_share >= 0.5; }

/// True if at most one step in a hundred has no answer. Otherwise a solver that gives up looks
/// fast.
bool answers(const BenchmarkRow& row) { return row.unsolved_share <= 0.01; }

/// Returns all conditions of a row but its index and solver. The largest mesh with the largest
/// sphere sorts last.
auto conditions(const BenchmarkRow& row) {
  return std::tie(row.triangles, row.radius, row.activation, row.mesh);
}

double median(const BenchmarkRow* row) { return row->step->p50; }

/// Returns the rows that the headline may compare, all under the conditions that sort last: those
/// of both pairs, or all rows if a pair is missing.
Rows compared(const Benchmark& benchmark) {
  Rows rows;
  for (const BenchmarkRow& row : benchmark.rows) {
    if (row.step && row.step->p50 > 0.0 && reaches(row) && answers(row)) rows.push_back(&row);
  }
  if (rows.empty()) return rows;
  const auto largest = std::ranges::max(
      rows, [](const auto* a, const auto* b) { return conditions(*a) < conditions(*b); });
  std::erase_if(rows, [&](const auto* row) { return conditions(*row) != conditions(*largest); });
  Rows both;
  std::ranges::copy_if(rows, std::back_inserter(both), [](const auto* row) {
    return std::ranges::any_of(pairs, [&](const Pair& pair) {
      return row->index == pair.index && row->solver == pair.solver;
    });
  });
  return both.size() == pairs.size() ? both : rows;
}

/// Returns the hash over all steps of a row, or over the first of them, a power of two.
std::uint64_t hash_over(const BenchmarkRow& row, std::size_t steps) {
  return row.queries == steps ? row.hash : row.first_hashes[std::bit_width(steps) - 1];
}

}  // namespace

Json ranking_of(const Benchmark& benchmark) {
  const auto& all = benchmark.rows;
  const auto number = [&](const BenchmarkRow* row) { return row - all.data(); };
  const auto count = [&](const auto& is_left_out) {
    return std::ranges::count_if(all, is_left_out);
  };
  Json ranking = {
      {"fastest", nullptr},
      {"slowest", nullptr},
      {"not_finished", benchmark.planned - std::min(all.size(), benchmark.planned)},
      {"not_timed", count([](const auto& row) { return !row.step; })},
      {"reach_nothing", count([](const auto& row) { return row.step && !reaches(row); })},
      {"unanswered", count([](const auto& row) { return row.step && !answers(row); })}};
  if (const Rows rows = compared(benchmark); !rows.empty()) {
    const auto [fastest, slowest] = std::ranges::minmax(rows, {}, median);
    ranking["fastest"] = number(fastest);
    ranking["slowest"] = number(slowest);
  }
  return ranking;
}

Json step_groups_of(const Benchmark& benchmark) {
  using Problem = decltype(std::pair(conditions(benchmark.rows[0]), std::string()));
  std::map<Problem, Rows> groups;
  std::size_t not_verified = 0, single = 0, members = 0, compared = 0, same = 0;
  for (const BenchmarkRow& row : benchmark.rows) {
    if (row.verified && row.queries > 0) {
      groups[{conditions(row), row.solver}].push_back(&row);
    } else {
      ++not_verified;
    }
  }
  std::size_t fewest = std::numeric_limits<std::size_t>::max(), most = 0;
  for (const auto& [problem, rows] : groups) {
    if (rows.size() < 2) {
      ++single;
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
  return {{"groups", compared},
          {"rows", members},
          {"same", same},
          {"fewest_steps", compared > 0 ? Json(fewest) : Json()},
          {"most_steps", compared > 0 ? Json(most) : Json()},
          {"single", single},
          {"not_verified", not_verified}};
}

std::string headline(const Benchmark& benchmark) {
  const Rows rows = compared(benchmark);
  if (rows.empty()) return "No combination was timed with triangles in reach and 99 % answers.";
  const auto [fastest, slowest] = std::ranges::minmax(rows, {}, median);
  const auto time = [](const BenchmarkRow* row) {
    return time_text(median(row)) + " with " + row->index + " and " + row->solver;
  };
  return "Under rule " + fastest->activation + " on " + fastest->mesh + " (" +
         counted(fastest->triangles, "triangle") + "), a step takes " + time(fastest) +
         (fastest == slowest
              ? "."
              : ", " + time(slowest) + ": " + ratio_text(median(slowest) / median(fastest)) +
                    " times as long.");
}

}  // namespace keepout::app
