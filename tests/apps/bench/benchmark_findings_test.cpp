// SPDX-License-Identifier: BSD-3-Clause
#include "bench/benchmark_findings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "bench/benchmark_rows.h"
#include "bench/benchmark_verdict.h"
#include "benchmark_scene.h"
#include "number_text.h"

namespace keepout::app {
namespace {

using About = BenchmarkFinding::About;

/// The texts of all findings about something, a line each.
std::string told(const Benchmark& benchmark, std::optional<BenchmarkFinding::About> about = {}) {
  std::string all;
  for (const BenchmarkFinding& finding : findings(benchmark)) {
    if (!about || finding.about == *about) all += finding.text + '\n';
  }
  return all;
}

std::size_t how_many(const Benchmark& benchmark, BenchmarkFinding::About about) {
  const std::vector<BenchmarkFinding> all = findings(benchmark);
  return static_cast<std::size_t>(std::ranges::count(all, about, &BenchmarkFinding::about));
}

bool has(const std::string& page, const std::string& words) {
  return page.find(words) != std::string::npos;
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
  EXPECT_FALSE(has(told(benchmark), "r = 5\u00a0mm"));
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

TEST(BenchmarkRates, AreSaidToPassOneKilohertzWhereTheLineInThePlotDoes) {
  Benchmark benchmark = duel();
  std::erase_if(benchmark.rows, [](const BenchmarkRow& row) { return row.radius == 1.0; });
  // 4 kHz at 1,000 triangles and 0.25 kHz at 64,000: half way in logarithms is 8,000.
  for (BenchmarkRow& row : benchmark.rows) {
    if (row.index == "fcl_obbrss") row.step->p50 = row.triangles < 2000 ? 250.0 : 4000.0;
  }
  std::string page = told(benchmark, About::rates);
  EXPECT_TRUE(has(page,
                  "fcl_obbrss, paper, nlopt_slsqp, r = 5\u00a0mm: 0.250\u00a0kHz at 64,000 "
                  "triangles; it falls below 1\u00a0kHz at about 8,000 triangles, between the "
                  "meshes of 1,000 and 64,000."));
  EXPECT_TRUE(has(page,
                  "wide_bvh, paper, active_set, r = 5\u00a0mm: 250\u00a0kHz at 64,000 "
                  "triangles; 1\u00a0kHz is kept up to there, the largest here."));
  for (BenchmarkRow& row : benchmark.rows) {
    if (row.index == "fcl_obbrss") row.step->p50 = 4000.0;
  }
  EXPECT_TRUE(has(told(benchmark), "1\u00a0kHz is not reached from 1,000 on."));
}

/// Faster than any, for it gives up.
BenchmarkRow quitter(const Benchmark& benchmark) {
  BenchmarkRow row = benchmark.rows[1];
  row.index = "quick_index";
  row.solver = "quitter";
  for (Stage stage : {&BenchmarkRow::collect, &BenchmarkRow::query, &BenchmarkRow::activate,
                      &BenchmarkRow::solve, &BenchmarkRow::step}) {
    row.*stage = made_up_timing(1e-3, row.queries);
  }
  row.unsolved_share = 0.4;
  return row;
}

TEST(BenchmarkFindings, AreOfEveryMeshSphereAndRule) {
  Benchmark benchmark = made_up_benchmark({51978, 985856});
  const std::size_t rows = benchmark.rows.size();
  for (std::size_t i = 0; i < rows; ++i) {
    benchmark.rows.push_back(benchmark.rows[i]);
    benchmark.rows.back().mesh = "skull";
    if (benchmark.rows[i].activation != "certified") continue;
    benchmark.rows.push_back(benchmark.rows[i]);
    benchmark.rows.back().activation = "all_faces";
  }
  std::map<std::pair<About, std::string>, std::size_t> found;
  for (const BenchmarkFinding& finding : findings(benchmark)) {
    ++found[{finding.about, finding.mesh}];
    for (const BenchmarkRow* row : finding.rows) EXPECT_EQ(row->mesh, finding.mesh);
  }
  for (const char* mesh : {"bunny", "skull"}) {
    EXPECT_EQ((found[{About::queries, mesh}]), made_up_radii().size()) << mesh;
    EXPECT_EQ((found[{About::stages, mesh}]), made_up_radii().size()) << mesh;
    EXPECT_EQ((found[{About::solvers, mesh}]), 1U) << mesh;
    EXPECT_EQ((found[{About::costs, mesh}]), 1U) << mesh;
  }
  const std::string rates = told(benchmark, About::rates);
  for (const char* rule : {"certified", "paper", "all_faces"}) {
    EXPECT_TRUE(has(rates, std::string("wide_bvh, ") + rule + ", active_set")) << rule;
  }
}

TEST(BenchmarkFindings, PraiseNoRowThatGivesUp) {
  Benchmark benchmark = made_up_benchmark({985856});
  benchmark.rows.push_back(quitter(benchmark));
  const std::string words = told(benchmark);
  EXPECT_FALSE(has(words, "quick_index"));
  EXPECT_TRUE(has(
      words, "Shown, but not ranked: 1 row of quitter with more than 1 % of the steps without"));
  EXPECT_TRUE(has(words, "active_set finds the motion in"));
  for (const BenchmarkFinding& finding : findings(benchmark)) {
    const bool is_shown = std::ranges::any_of(
        finding.rows, [](const BenchmarkRow* row) { return row->solver == "quitter"; });
    EXPECT_EQ(is_shown, finding.about == About::solvers || finding.about == About::costs)
        << finding.text;
  }
  benchmark.rows.back().unsolved_share = 0.01;
  EXPECT_TRUE(has(told(benchmark), "quitter finds the motion in"));
}

TEST(BenchmarkFindings, LeaveOutRatesOfStepsThatTookNoTime) {
  Benchmark benchmark = made_up_benchmark({51978, 985856});
  for (BenchmarkRow& row : benchmark.rows) {
    if (row.index != "wide_bvh" || row.triangles > 100000) continue;
    row.collect->p50 = row.query->p50 = row.solve->p50 = row.step->p50 = 0.0;
  }
  EXPECT_FALSE(has(told(benchmark), "inf"));
  EXPECT_FALSE(has(told(benchmark), "nan"));
  for (BenchmarkRow& row : benchmark.rows) row.unsolved_share = 1.0;
  EXPECT_EQ(how_many(benchmark, About::rates), 0U);
  EXPECT_EQ(how_many(benchmark, About::stages), 0U);
  EXPECT_TRUE(has(told(benchmark), "No row is ranked: none has triangles in reach and an answer"));
}

TEST(BenchmarkFindings, ThereAreNoneOfWhatHasNoRows) {
  EXPECT_TRUE(findings({}).empty());
  Benchmark untimed = made_up_benchmark({51978});
  for (BenchmarkRow& row : untimed.rows) {
    row.collect = row.query = row.step_query = row.activate = row.solve = row.step = std::nullopt;
    row.build_s = 0.0;
    row.verified = false;
  }
  for (const BenchmarkFinding& finding : findings(untimed)) {
    EXPECT_EQ(finding.about, About::steps) << finding.text;
  }
  EXPECT_EQ(headline(untimed), "No step was timed.");
}

TEST(BenchmarkJson, HasEveryRowAndWhichOnesAFindingIsOf) {
  const Benchmark benchmark = made_up_benchmark();
  const Json json = json_of(benchmark);
  ASSERT_EQ(json["rows"].size(), benchmark.rows.size());
  EXPECT_EQ(json["headline"], headline(benchmark));
  EXPECT_EQ(json["published"][1]["khz"], 0.18);
  const std::vector<BenchmarkFinding> all = findings(benchmark);
  ASSERT_EQ(json["findings"].size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Json& finding = json["findings"][i];
    EXPECT_EQ(finding["text"], all[i].text);
    ASSERT_EQ(finding["rows"].size(), all[i].rows.size());
    for (std::size_t k = 0; k < all[i].rows.size(); ++k) {
      const Json& row = json["rows"][finding["rows"][k].get<std::size_t>()];
      EXPECT_EQ(row["index"], all[i].rows[k]->index);
      EXPECT_EQ(row["triangles"], all[i].rows[k]->triangles);
    }
  }
}

TEST(BenchmarkFindings, TellsWhereAllIndicesMadeTheSameSteps) {
  Benchmark benchmark = made_up_benchmark({51978});
  // Brute force was asked the first 200 motions only: of these 128 have a hash in common.
  EXPECT_TRUE(
      has(told(benchmark),
          "in 8 groups, made the same steps in 8 of them, as far as they were asked for the "
          "same, the first 128 to 10,000 motions. Left out: 20 rows without such another."));
  benchmark.rows[2].hash ^= 1U;
  EXPECT_TRUE(has(told(benchmark), "in 8 groups, made the same steps in 7 of them"));
  benchmark.rows[0].first_hashes[7] ^= 1U;
  EXPECT_TRUE(has(told(benchmark), "in 8 groups, made the same steps in 7 of them"));
  benchmark.rows[0].verified = false;
  EXPECT_TRUE(has(told(benchmark), "Left out: 1 row not verified."));
}

TEST(BenchmarkFindings, SetsSolversAgainstEachOtherThatThePlotShowsWithAsManyPlanes) {
  Benchmark benchmark;
  const auto add = [&](const char* index, const char* solver, double planes, double us) {
    BenchmarkRow row = duel().rows.front();
    row.index = index;
    row.solver = solver;
    row.planes_mean = planes;
    row.solve = made_up_timing(us, row.queries);
    benchmark.rows.push_back(row);
  };
  add("wide_bvh", "active_set", 2.14, 0.109);  // leaves planes out
  add("pd_tree", "active_set", 26.0, 0.5);
  add("embree", "active_set", 26.0, 0.6);
  add("wide_bvh", "nlopt_mma", 26.0, 197.0);
  add("wide_bvh", "nlopt_slsqp", 25.8, 30.0);
  const std::string page = told(benchmark);
  EXPECT_TRUE(has(page,
                  "active_set finds the motion in 0.500\u00a0µs among 26.0 planes in the mean and "
                  "nlopt_mma finds the motion in 197\u00a0µs among 26.0 planes in the mean;"))
      << page;
  EXPECT_FALSE(has(page, "2.14"));
  // One that is given far fewer is not set against the others.
  std::erase_if(benchmark.rows, [](const BenchmarkRow& row) {
    return row.solver == "active_set" ? row.index != "wide_bvh" : row.solver == "nlopt_slsqp";
  });
  EXPECT_TRUE(has(told(benchmark),
                  "nlopt_mma finds the motion in 197\u00a0µs among 26.0 planes in the mean, and no "
                  "other solver was given as many;"));
}

TEST(BenchmarkFindings, OfOneIndexRanksNothing) {
  Benchmark benchmark;
  benchmark.rows = {duel().rows.front()};
  BenchmarkRow& row = benchmark.rows.front();
  row.build_s = 0.0122;
  row.build_cores = 0.31;
  row.bytes_per_triangle = 80.0;
  const std::string page = told(benchmark);
  EXPECT_TRUE(has(page,
                  "On ball with 1,000 triangles, wide_bvh is built in 0.0122 s with 0.31 cores "
                  "busy, and takes 80.0 bytes a triangle. Reading"))
      << page;
  EXPECT_FALSE(has(page, "slowest, in"));
  EXPECT_FALSE(has(page, "Left out:")) << "nothing was compared";
}

TEST(BenchmarkFindings, SaysThatTimesToBuildOnABusyMachineIncludeWaiting) {
  Benchmark benchmark = made_up_benchmark({51978});
  benchmark.machine.cores = 2;
  benchmark.others_cores = 0.02;
  EXPECT_FALSE(has(told(benchmark), "include waiting"));
  benchmark.others_cores = 1.7;
  EXPECT_TRUE(has(told(benchmark), "times to build include waiting for a core"));
}

}  // namespace
}  // namespace keepout::app
