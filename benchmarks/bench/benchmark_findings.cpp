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

/// Returns all conditions of a row but its index and solver. The largest mesh with the largest
/// sphere sorts last.
auto conditions(const BenchmarkRow& row) {
  return std::tie(row.triangles, row.radius, row.activation, row.mesh);
}

double median(const BenchmarkRow* row) { return row->step->p50; }

/// Returns the hash over all steps of a row, or over the first of them, a power of two.
std::uint64_t hash_over(const BenchmarkRow& row, std::size_t steps) {
  return row.queries == steps ? row.hash : row.first_hashes[std::bit_width(steps) - 1];
}

}  // namespace

Ranking ranking_of(const Benchmark& benchmark) {
  Rows rows;
  for (const BenchmarkRow& row : benchmark.rows) {
    if (row.step && row.step->p50 > 0.0 && row.remark.empty()) rows.push_back(&row);
  }
  if (rows.empty()) return {};
  const auto largest = std::ranges::max(
      rows, [](const auto* a, const auto* b) { return conditions(*a) < conditions(*b); });
  std::erase_if(rows, [&](const auto* row) { return conditions(*row) != conditions(*largest); });
  Rows both;
  std::ranges::copy_if(rows, std::back_inserter(both), [](const auto* row) {
    return std::ranges::any_of(pairs, [&](const Pair& pair) {
      return row->index == pair.index && row->solver == pair.solver;
    });
  });
  const auto [fastest, slowest] =
      std::ranges::minmax(both.size() == pairs.size() ? both : rows, {}, median);
  return {fastest, slowest};
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
  const auto [fastest, slowest] = ranking_of(benchmark);
  if (fastest == nullptr) return "No combination was timed that can be ranked.";
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
