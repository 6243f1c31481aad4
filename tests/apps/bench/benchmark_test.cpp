// SPDX-License-Identifier: BSD-3-Clause
// The rows that the headline of a benchmark compares or leaves out, and its groups of equal steps.
#include <algorithm>
#include <set>
#include <utility>

#include "bench/bench.h"
#include "compare/compare.h"
#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/solvers/registry.h"
#include "messages.h"

namespace keepout::app {
namespace {

/// Two meshes, two spheres, two pairs of parts. A step takes 4 µs with the first pair, else 200 µs.
Benchmark duel() {
  Benchmark benchmark;
  for (const std::size_t triangles : {1000, 64000}) {
    for (const double radius : {1.0, 5.0}) {
      for (const Pair& pair : pairs) {
        const double us = benchmark.rows.size() % 2 == 0 ? 4.0 : 200.0;
        BenchmarkRow& row = benchmark.rows.emplace_back(new_row());
        row.update({{"mesh", "ball"},
                    {"triangles", triangles},
                    {"radius", radius},
                    {"index", pair.index},
                    {"activation", "paper"},
                    {"solver", pair.solver},
                    {"queries", 100},
                    {"step_us", {{"p50", us}}},
                    {"rate_khz", 1e3 / us}});
      }
    }
  }
  return benchmark;
}

TEST(BenchmarkRanking, ComparesTheLargestMeshUnderTheSameConditions) {
  Benchmark benchmark = duel();
  const auto expect_ranking = [&](std::size_t fastest, std::size_t slowest, const char* why) {
    const Ranking ranking = ranking_of(benchmark);
    EXPECT_EQ(ranking.fastest, &benchmark.rows[fastest]) << why;
    EXPECT_EQ(ranking.slowest, &benchmark.rows[slowest]) << why;
  };
  expect_ranking(6, 7, "with the largest sphere on the largest mesh");
  EXPECT_CONTAINS(headline(benchmark), ": 50 times");
  BenchmarkRow added = benchmark.rows.back();
  added["solver"] = "nlopt_mma";
  added["step_us"]["p50"] = 1e5;
  benchmark.rows.push_back(added);
  expect_ranking(6, 7, "the two pairs");
  benchmark.rows[7]["index"] = "embree";
  expect_ranking(6, 8, "all, where a pair is missing");
  benchmark.rows[8]["activation"] = "all_faces";
  expect_ranking(6, 7, "of one rule");
  benchmark.rows[6]["step_us"]["p50"] = 4000.0;
  expect_ranking(7, 6, "whichever is the faster");
  EXPECT_CONTAINS(headline(benchmark), ": 20 times");
}

TEST(BenchmarkRanking, LeavesOutRowsThatAreNotTimedOrHaveARemark) {
  const std::vector<void (*)(BenchmarkRow&)> cases = {
      [](BenchmarkRow& row) { row["step_us"] = nullptr; },
      [](BenchmarkRow& row) { row["remark"] = "not ranked"; },
      [](BenchmarkRow& row) { row["queries"] = 5; },
      [](BenchmarkRow& row) { row["step_us"]["p50"] = 0.0; }};  // the clock is too coarse
  for (const auto& spoil : cases) {
    Benchmark benchmark = duel();
    spoil(benchmark.rows[7]);
    EXPECT_EQ(ranking_of(benchmark).slowest, &benchmark.rows[6]) << "alone";
    spoil(benchmark.rows[6]);
    EXPECT_EQ(ranking_of(benchmark).slowest, &benchmark.rows[5]) << "with the other sphere";
    for (BenchmarkRow& row : benchmark.rows) spoil(row);
    EXPECT_EQ(ranking_of(benchmark).fastest, nullptr);
    EXPECT_TRUE(json_of(benchmark)["slowest"].is_null());
    EXPECT_LACKS(headline(benchmark), "times as long");
  }
}

TEST(BenchmarkStatus, IsAFailureIfAnswersAreWrongOrPartsDisagree) {
  Benchmark benchmark = duel();
  EXPECT_TRUE(is_right(benchmark, {}));
  EXPECT_LACKS(headline(benchmark), "wrong");
  Comparison disagreeing;
  disagreeing.indices.push_back({.missed = 1});
  EXPECT_FALSE(is_right(benchmark, disagreeing));
  benchmark.rows[2]["wrong"] = true;
  EXPECT_FALSE(is_right(benchmark, {}));
  EXPECT_CONTAINS(headline(benchmark), " The answers of 1 of 8 rows are wrong.");
}

TEST(BenchmarkStepGroups, CountTheGroupsInWhichAllIndicesMadeTheSameSteps) {
  Benchmark benchmark;
  for (const double radius : {5.0, 1.0}) {
    for (const auto& [index, steps] :
         {std::pair("brute_force", 200UL), std::pair("pd_tree", 10000UL),
          std::pair("wide_bvh", 10000UL)}) {
      BenchmarkRow& row = benchmark.rows.emplace_back(new_row());
      row.update({{"radius", radius},
                  {"index", index},
                  {"activation", "paper"},
                  {"queries", steps},
                  {"hash", std::to_string(steps)},
                  {"verified", true}});
      for (std::size_t n = 1; n <= steps; n *= 2) {
        row["hashes_of_first"][std::to_string(n)] = std::to_string(n);
      }
    }
  }
  benchmark.rows.push_back(benchmark.rows.back());
  benchmark.rows.back()["activation"] = "certified";
  // Brute force solved only the first 200 motions. The longest common hash is of 128 steps.
  const Json expected = {
      {"groups", 2},          {"rows", 6},   {"same", 2},        {"fewest_steps", 128},
      {"most_steps", 10'000}, {"single", 1}, {"not_verified", 0}};
  EXPECT_EQ(step_groups_of(benchmark), expected);
  benchmark.rows[2]["hash"] = "another";
  EXPECT_EQ(step_groups_of(benchmark)["same"], 1);
  benchmark.rows[0]["verified"] = false;
  EXPECT_EQ(step_groups_of(benchmark)["not_verified"], 1);
}

TEST(BenchmarkJson, HasEveryRowAndEveryFinding) {
  const Benchmark benchmark = duel();
  const Json json = json_of(benchmark);
  ASSERT_EQ(json["rows"].size(), benchmark.rows.size());
  EXPECT_EQ(json["headline"], headline(benchmark));
  EXPECT_EQ(json["fastest"], 6);
  EXPECT_EQ(json["slowest"], 7);
  EXPECT_EQ(json["step_groups"], step_groups_of(benchmark));
  EXPECT_EQ(json["published"][1]["khz"], 0.18);
  EXPECT_EQ(json["rows"], Json(benchmark.rows));
}

TEST(Combinations, OfNothingAskedForHaveEveryPartOnceAndThoseOfAnIndexTogether) {
  const std::vector<Combination> all = combinations_of({});
  std::set<std::string> seen_indices, seen_rules, seen_solvers;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool is_new = seen_indices.insert(all[i].index).second;
    EXPECT_EQ(is_new, i == 0 || all[i].index != all[i - 1].index) << "would be built twice";
    seen_rules.insert(all[i].activation);
    seen_solvers.insert(all[i].solver);
    EXPECT_EQ(std::ranges::count(all, all[i]), 1);
  }
  EXPECT_EQ(seen_indices.size(), index_backends().size() - 1) << "all but the reference";
  EXPECT_EQ(seen_rules.size(), activation_rules().size());
  EXPECT_EQ(seen_solvers.size(), solver_backends().size());
  const std::size_t quick = combinations_of({.radii = {5.0, 1.0}}).size();
  EXPECT_LT(quick, all.size());
  EXPECT_GE(quick, 5u);
}

TEST(Combinations, CrossWhatWasAskedForAndTakeTheReferenceForTheRest) {
  const std::vector<Combination> expected = {{"brute_force", "paper", "active_set", 2.0},
                                             {"brute_force", "certified", "active_set", {}},
                                             {"pd_tree", "paper", "active_set", 2.0},
                                             {"pd_tree", "certified", "active_set", {}}};
  EXPECT_EQ(combinations_of({.indices = {"pd_tree", "brute_force"}, .radii = {2.0}}), expected);
}

TEST(Combinations, ListTheCertifiedRuleOnceWhateverTheRadii) {
  const auto all = combinations_of({.activations = {"certified"}, .radii = {5.0, 1.0}});
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].radius, std::nullopt);
}

}  // namespace
}  // namespace keepout::app
