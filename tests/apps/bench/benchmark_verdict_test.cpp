// SPDX-License-Identifier: BSD-3-Clause
// The verdict of a benchmark: which rows it compares, by which factor, and which it leaves out.
#include "bench/benchmark_verdict.h"

#include <utility>

#include "messages.h"
#include "shared/number_text.h"

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

TEST(BenchmarkVerdict, ComparesTheLargestMeshUnderTheSameConditions) {
  Benchmark benchmark = duel();
  EXPECT_CONTAINS(headline(benchmark), ": 50 times as long");
  for (const char* figure : {"2,500 and 120 steps", "64,000 triangles", "12 times"}) {
    EXPECT_CONTAINS(account(benchmark), figure);
  }
  for (BenchmarkRow& row : benchmark.rows) {
    if (row.index == "wide_bvh") row.step->p50 *= 1000.0;
  }
  EXPECT_TRUE(headline(benchmark).starts_with("fcl_obbrss")) << "the faster one";
  EXPECT_CONTAINS(headline(benchmark), ": 20 times as long");
  for (BenchmarkRow& row : benchmark.rows) row.step.reset();
  EXPECT_EQ(headline(benchmark), "No step was timed.");
}

TEST(BenchmarkVerdict, RanksNoRowThatIsShortOrUnsolvedOrReachesNothing) {
  Benchmark few = duel();
  few.rows.back().queries = 99;  // with the largest sphere on the largest mesh
  EXPECT_CONTAINS(headline(few), ": 12 times as long");
  Benchmark unsolved = duel();
  unsolved.rows.back().unsolved_share = 0.4;
  unsolved.rows[4].step->p50 = 0.0;  // ours with the other sphere
  EXPECT_CONTAINS(headline(unsolved), "2.00\u00a0µs");
  EXPECT_CONTAINS(account(unsolved), "1 of 8 rows was not ranked");
  for (BenchmarkRow& row : unsolved.rows) row.unsolved_share = 0.4;
  EXPECT_CONTAINS(account(unsolved), "8 of 8 rows were not ranked");
  Benchmark unreached = duel();
  for (BenchmarkRow& row : unreached.rows) {
    if (row.radius == 5.0) row.reaching_share = 0.4;
  }
  EXPECT_CONTAINS(headline(unreached), ": 12 times as long");
  EXPECT_CONTAINS(account(unreached), "4 of 8 rows were not ranked");
}

TEST(BenchmarkVerdict, SaysIfTheMachineWasBusyOrTheRunIsIncomplete) {
  Benchmark benchmark = duel();
  benchmark.machine.cores = 2;
  benchmark.others_cores = 0.02;
  EXPECT_LACKS(account(benchmark), "busy");
  benchmark.others_cores = 0.8;
  benchmark.planned = 12;
  EXPECT_CONTAINS(account(benchmark), "busy");
  EXPECT_CONTAINS(account(benchmark), "8 of 12 rows");
}

TEST(BenchmarkVerdict, CountsTheGroupsInWhichAllIndicesMadeTheSameSteps) {
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
  for (const char* figure : {"2 groups", "in 2 of them", "first 128 to 10,000", "1 row without"}) {
    EXPECT_CONTAINS(same_steps(benchmark), figure);
  }
  benchmark.rows[2].hash ^= 1U;
  EXPECT_CONTAINS(same_steps(benchmark), "in 1 of them");
  benchmark.rows[0].verified = false;
  EXPECT_CONTAINS(same_steps(benchmark), "1 row not verified");
}

TEST(BenchmarkJson, HasEveryRowAndEveryVerdict) {
  const Benchmark benchmark = duel();
  const Json json = json_of(benchmark);
  ASSERT_EQ(json["rows"].size(), benchmark.rows.size());
  EXPECT_EQ(json["headline"], headline(benchmark));
  EXPECT_EQ(json["account"], account(benchmark));
  EXPECT_EQ(json["same_steps"], same_steps(benchmark));
  EXPECT_EQ(json["published"][1]["khz"], 0.18);
  for (std::size_t i = 0; i < benchmark.rows.size(); ++i) {
    EXPECT_EQ(json["rows"][i]["index"], benchmark.rows[i].index);
    EXPECT_EQ(json["rows"][i]["rate_khz"], 1e3 / benchmark.rows[i].step->p50);
  }
}

}  // namespace
}  // namespace keepout::app
