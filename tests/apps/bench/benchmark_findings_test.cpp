// SPDX-License-Identifier: BSD-3-Clause
// What a benchmark finds: which rows its headline compares, which it leaves out, and equal steps.
#include <utility>

#include "bench/benchmark.h"
#include "messages.h"

namespace keepout::app {
namespace {

Timing made_up_timing(double median, std::size_t samples) {
  Timing timing{.p50 = median, .max = 40.0 * median, .samples = samples};
  if (samples >= 100) timing.p99 = 2.4 * median;
  return timing;
}

/// Our pair takes 4 us and its peer 200 at 5 mm; 1 and 12 at 1 mm.
Benchmark duel() {
  Benchmark benchmark;
  for (const std::size_t triangles : {std::size_t{1000}, std::size_t{64000}}) {
    for (const double radius : {1.0, 5.0}) {
      for (const bool ours : {true, false}) {
        BenchmarkRow row;
        row.mesh = "ball";
        row.triangles = triangles;
        row.radius = radius;
        row.index = ours ? "wide_bvh" : "fcl_obbrss";
        row.activation = "paper";
        row.solver = ours ? "active_set" : "nlopt_slsqp";
        const double us = ours ? radius < 2.0 ? 1.0 : 4.0 : radius < 2.0 ? 12.0 : 200.0;
        row.queries = ours ? 2500 : 120;
        row.step = made_up_timing(triangles < 2000 ? 0.5 * us : us, row.queries);
        row.reaching_share = 1.0;
        row.verified = true;
        benchmark.rows.push_back(row);
      }
    }
  }
  return benchmark;
}

TEST(BenchmarkRanking, ComparesTheLargestMeshUnderTheSameConditions) {
  Benchmark benchmark = duel();
  Json ranking = ranking_of(benchmark);
  EXPECT_EQ(ranking["fastest"], 6u) << "with the largest sphere on the largest mesh";
  EXPECT_EQ(ranking["slowest"], 7u);
  EXPECT_CONTAINS(headline(benchmark), ": 50 times");
  // Other parts under the same conditions, and other conditions.
  benchmark.rows.push_back(benchmark.rows.back());
  benchmark.rows.back().solver = "nlopt_mma";
  benchmark.rows.back().step->p50 = 1e5;
  EXPECT_EQ(ranking_of(benchmark)["slowest"], 7u) << "the two pairs";
  benchmark.rows[7].index = "embree";
  EXPECT_EQ(ranking_of(benchmark)["slowest"], 8u) << "all, where a pair is missing";
  benchmark.rows.back().activation = "all_faces";
  EXPECT_EQ(ranking_of(benchmark)["slowest"], 7u) << "of one rule";

  benchmark = duel();
  for (BenchmarkRow& row : benchmark.rows) {
    if (row.index == "wide_bvh") row.step->p50 *= 1000.0;
  }
  ranking = ranking_of(benchmark);
  EXPECT_EQ(ranking["fastest"], 7u);
  EXPECT_EQ(ranking["slowest"], 6u);
  EXPECT_CONTAINS(headline(benchmark), ": 20 times");
}

TEST(BenchmarkRanking, LeavesOutRowsThatAreNotTimedOrUnansweredOrReachNothing) {
  const struct {
    const char* reason;
    void (*spoil)(BenchmarkRow&);
  } cases[] = {{"not_timed", [](BenchmarkRow& row) { row.step.reset(); }},
               {"unanswered", [](BenchmarkRow& row) { row.unsolved_share = 0.4; }},
               {"reach_nothing", [](BenchmarkRow& row) { row.reaching_share = 0.4; }}};
  for (const auto& [reason, spoil] : cases) {
    SCOPED_TRACE(reason);
    Benchmark benchmark = duel();
    EXPECT_EQ(ranking_of(benchmark)[reason], 0);
    spoil(benchmark.rows[7]);
    EXPECT_EQ(ranking_of(benchmark)["slowest"], 6u) << "alone";
    spoil(benchmark.rows[6]);
    EXPECT_EQ(ranking_of(benchmark)["slowest"], 5u) << "with the other sphere";
    EXPECT_EQ(ranking_of(benchmark)[reason], 2);
    for (BenchmarkRow& row : benchmark.rows) spoil(row);
    const Json ranking = ranking_of(benchmark);
    EXPECT_EQ(ranking[reason], 8);
    EXPECT_TRUE(ranking["fastest"].is_null() && ranking["slowest"].is_null());
    EXPECT_LACKS(headline(benchmark), "times as long");
  }
  Benchmark unseen = duel();
  unseen.rows[6].step->p50 = 0.0;  // the clock is too coarse
  EXPECT_EQ(ranking_of(unseen)["fastest"], 7u);
  unseen.planned = 12;
  EXPECT_EQ(ranking_of(unseen)["not_finished"], 4);
}

TEST(BenchmarkStepGroups, CountTheGroupsInWhichAllIndicesMadeTheSameSteps) {
  Benchmark benchmark;
  for (const double radius : {5.0, 1.0}) {
    for (const auto& [index, steps] : {std::pair("brute_force", 200), std::pair("pd_tree", 10000),
                                       std::pair("wide_bvh", 10000)}) {
      BenchmarkRow row;
      row.radius = radius;
      row.index = index;
      row.activation = "paper";
      row.queries = static_cast<std::size_t>(steps);
      row.hash = row.queries;
      for (std::size_t n = 1; n <= row.queries; n *= 2) row.first_hashes.push_back(n);
      row.verified = true;
      benchmark.rows.push_back(row);
    }
  }
  benchmark.rows.push_back(benchmark.rows.back());
  benchmark.rows.back().activation = "certified";
  // Brute force was asked the first 200 motions only: of these 128 have a hash in common.
  const Json expected = {
      {"groups", 2},          {"rows", 6},   {"same", 2},        {"fewest_steps", 128},
      {"most_steps", 10'000}, {"single", 1}, {"not_verified", 0}};
  EXPECT_EQ(step_groups_of(benchmark), expected);
  benchmark.rows[2].hash ^= 1U;
  EXPECT_EQ(step_groups_of(benchmark)["same"], 1);
  benchmark.rows[0].verified = false;
  EXPECT_EQ(step_groups_of(benchmark)["not_verified"], 1);
}

TEST(BenchmarkJson, HasEveryRowAndEveryFinding) {
  const Benchmark benchmark = duel();
  const Json json = json_of(benchmark);
  ASSERT_EQ(json["rows"].size(), benchmark.rows.size());
  EXPECT_EQ(json["headline"], headline(benchmark));
  EXPECT_EQ(json["ranking"], ranking_of(benchmark));
  EXPECT_EQ(json["step_groups"], step_groups_of(benchmark));
  EXPECT_EQ(json["published"][1]["khz"], 0.18);
  for (std::size_t i = 0; i < benchmark.rows.size(); ++i) {
    EXPECT_EQ(json["rows"][i]["index"], benchmark.rows[i].index);
    EXPECT_EQ(json["rows"][i]["rate_khz"], 1e3 / benchmark.rows[i].step->p50);
  }
}

}  // namespace
}  // namespace keepout::app
