// SPDX-License-Identifier: BSD-3-Clause
#include "bench/benchmark_verdict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "shared/number_text.h"

namespace keepout::app {
namespace {

bool has(const std::string& page, const std::string& words) {
  return page.find(words) != std::string::npos;
}

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

TEST(BenchmarkVerdict, SetsOurPairAgainstItsPeersOnTheLargestMesh) {
  Benchmark benchmark = duel();
  EXPECT_EQ(
      headline(benchmark),
      "wide_bvh with active_set answers a step in 4.00\u00a0µs, where fcl_obbrss with nlopt_slsqp "
      "takes 200\u00a0µs: 50 times as long.");
  EXPECT_EQ(
      account(benchmark),
      "Those are medians of 2,500 and 120 steps on ball with 64,000 triangles, rule paper, with a "
      "motion sphere of 5\u00a0mm. With a sphere of 1\u00a0mm it is 1.00\u00a0µs against "
      "12.0\u00a0µs, 12 times as long.");
}

TEST(BenchmarkVerdict, SaysSoWhereThePeerIsFaster) {
  Benchmark benchmark = duel();
  for (BenchmarkRow& row : benchmark.rows) {
    if (row.index == "wide_bvh") row.step->p50 *= 1000.0;
  }
  EXPECT_EQ(headline(benchmark),
            "fcl_obbrss with nlopt_slsqp answers a step in 200\u00a0µs, where wide_bvh with "
            "active_set takes 4000\u00a0µs: 20 times as long.");
  EXPECT_TRUE(has(account(benchmark), "Those are medians of 120 and 2,500 steps on ball with"));
}

TEST(BenchmarkVerdict, ComparesOnlyWhatMetTheSameConditions) {
  Benchmark benchmark = duel();
  for (BenchmarkRow& row : benchmark.rows) {
    if (row.index == "wide_bvh") row.activation = "all_faces";
  }
  EXPECT_EQ(headline(benchmark),
            "A step takes 4.00\u00a0µs with wide_bvh, all_faces, active_set, and 200\u00a0µs with "
            "fcl_obbrss, paper, nlopt_slsqp: 50 times as long.");
  benchmark.rows.resize(1);
  EXPECT_EQ(headline(benchmark),
            "A step takes 0.500\u00a0µs with wide_bvh, all_faces, active_set.");
  benchmark.rows[0].step.reset();
  EXPECT_EQ(headline(benchmark), "No step was timed.");
  EXPECT_EQ(account(benchmark), "1 of 1 row was not timed; the table of all rows says why.");
}

TEST(BenchmarkVerdict, TakesTooFewStepsForNoDuel) {
  Benchmark benchmark = duel();
  benchmark.rows.back().queries = 99;  // with the largest sphere on the largest mesh
  EXPECT_EQ(
      headline(benchmark),
      "wide_bvh with active_set answers a step in 1.00\u00a0µs, where fcl_obbrss with nlopt_slsqp "
      "takes 12.0\u00a0µs: 12 times as long.");
  for (BenchmarkRow& row : benchmark.rows) {
    if (row.index == "fcl_obbrss") row.queries = 99;
  }
  EXPECT_EQ(headline(benchmark),
            "A step takes 4.00\u00a0µs with wide_bvh, paper, active_set, and 200\u00a0µs with "
            "fcl_obbrss, paper, nlopt_slsqp: 50 times as long.");
  EXPECT_EQ(account(benchmark),
            "Those are medians of 2,500 and 99 steps on ball with 64,000 triangles, with a motion "
            "sphere of 5\u00a0mm.");
}

TEST(BenchmarkVerdict, RanksNothingThatGivesUpOrTakesNoTime) {
  Benchmark benchmark = duel();
  benchmark.rows.back().unsolved_share = 0.4;
  benchmark.rows[4].step->p50 = 0.0;  // ours with the other sphere
  EXPECT_EQ(
      headline(benchmark),
      "wide_bvh with active_set answers a step in 2.00\u00a0µs, where fcl_obbrss with nlopt_slsqp "
      "takes 100\u00a0µs: 50 times as long.");
  EXPECT_TRUE(has(account(benchmark),
                  "1 of 8 rows was not ranked: more than 1 % of the steps are without an answer."));
  for (BenchmarkRow& row : benchmark.rows) row.unsolved_share = 0.4;
  EXPECT_EQ(headline(benchmark),
            "No combination had triangles in reach and answered 99 % of its steps.");
  EXPECT_EQ(account(benchmark),
            "8 of 8 rows were not ranked: more than 1 % of the steps are without an answer.");
}

TEST(BenchmarkVerdict, RanksNothingThatReachesNoTriangle) {
  Benchmark benchmark = duel();
  for (BenchmarkRow& row : benchmark.rows) {
    if (row.radius == 5.0) row.reaching_share = 0.4;
  }
  EXPECT_EQ(
      headline(benchmark),
      "wide_bvh with active_set answers a step in 1.00\u00a0µs, where fcl_obbrss with nlopt_slsqp "
      "takes 12.0\u00a0µs: 12 times as long.");
  EXPECT_TRUE(
      has(account(benchmark),
          "4 of 8 rows were not ranked: for more than half of the motions no triangle is in "
          "reach."));
}

TEST(BenchmarkVerdict, SaysWhetherTheMachineWasBusyAndTheRunComplete) {
  Benchmark benchmark = duel();
  benchmark.machine.cores = 2;
  EXPECT_FALSE(has(account(benchmark), "busy"));
  benchmark.others_cores = 0.02;
  EXPECT_TRUE(has(account(benchmark), "Other processes kept 0.020 of its 2 cores at work"));
  benchmark.others_cores = 0.8;
  EXPECT_TRUE(has(account(benchmark), "The machine was busy: other processes kept 0.80 of its 2"));
  benchmark.planned = 12;
  EXPECT_TRUE(has(account(benchmark), "Incomplete: it was stopped after 8 of 12 rows."));
}

TEST(BenchmarkVerdict, CallsPartsWhatTheyCallThemselves) {
  Benchmark benchmark = duel();
  benchmark.parts = {{"wide_bvh", "sixteen boxes"}, {"fcl_obbrss", "boxes of FCL"}};
  EXPECT_TRUE(has(account(benchmark),
                  "Of the names, wide_bvh stands for \u201csixteen boxes\u201d; fcl_obbrss stands "
                  "for \u201cboxes of FCL\u201d."));
}

TEST(BenchmarkVerdict, TellsWhereAllIndicesMadeTheSameSteps) {
  Benchmark benchmark;
  for (const auto& [rule, radius] : {std::pair("paper", 5.0), std::pair("paper", 1.0)}) {
    for (const auto& [index, steps] : {std::pair("brute_force", 200), std::pair("pd_tree", 10000),
                                       std::pair("wide_bvh", 10000)}) {
      BenchmarkRow row;
      row.radius = radius;
      row.index = index;
      row.activation = rule;
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
  EXPECT_TRUE(
      has(same_steps(benchmark),
          "6 in 2 groups, made the same steps in 2 of them, as far as they were asked for the "
          "same, the first 128 to 10,000 motions. Left out: 1 row without such another."));
  benchmark.rows[2].hash ^= 1U;
  EXPECT_TRUE(has(same_steps(benchmark), "in 2 groups, made the same steps in 1 of them"));
  benchmark.rows[0].first_hashes[7] ^= 1U;
  EXPECT_TRUE(has(same_steps(benchmark), "in 2 groups, made the same steps in 1 of them"));
  benchmark.rows[0].verified = false;
  EXPECT_TRUE(has(same_steps(benchmark), "Left out: 1 row not verified."));
}

TEST(BenchmarkJson, HasEveryRowAndEveryVerdict) {
  const Benchmark benchmark = duel();
  const Json json = json_of(benchmark);
  ASSERT_EQ(json["rows"].size(), benchmark.rows.size());
  EXPECT_EQ(json["headline"], headline(benchmark));
  EXPECT_EQ(json["account"], account(benchmark));
  EXPECT_EQ(json["same_steps"], same_steps(benchmark));
  EXPECT_EQ(json["published"][1]["khz"], 0.18);
  EXPECT_EQ(json["pairs"][0]["index"], "wide_bvh");
  for (std::size_t i = 0; i < benchmark.rows.size(); ++i) {
    const BenchmarkRow& row = benchmark.rows[i];
    EXPECT_EQ(json["rows"][i]["index"], row.index);
    if (row.step) {
      EXPECT_EQ(json["rows"][i]["rate_khz"], 1e3 / row.step->p50);
    }
  }
}

}  // namespace
}  // namespace keepout::app
