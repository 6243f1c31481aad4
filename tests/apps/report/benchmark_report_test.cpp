// SPDX-License-Identifier: BSD-3-Clause
#include "report/benchmark_report.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "benchmark_scene.h"
#include "number_text.h"
#include "report/benchmark_rows.h"
#include "report/benchmark_verdict.h"
#include "report/html_report.h"
#include "report_scene.h"

namespace keepout::app {
namespace {

std::string page_of(const Benchmark& benchmark, const Comparison& comparison) {
  std::ostringstream page;
  print_benchmark_report(page, benchmark, comparison);
  return page.str();
}

std::string sections_of(const Benchmark& benchmark, const Comparison& comparison) {
  std::ostringstream sections;
  print_benchmark_sections(sections, benchmark, comparison);
  return sections.str();
}

std::size_t how_many(const std::string& page, const std::string& words) {
  std::size_t count = 0;
  for (std::size_t at = page.find(words); at != std::string::npos; at = page.find(words, at + 1)) {
    ++count;
  }
  return count;
}

bool has(const std::string& page, const std::string& words) {
  return page.find(words) != std::string::npos;
}

/// The first table whose section has this title.
std::string table_below(const std::string& page, const std::string& title) {
  const std::size_t start = page.find("<table", page.find("<h2>" + title));
  return page.substr(start, page.find("</table>", start) - start);
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
  EXPECT_FALSE(has(page_of(benchmark, {}), "r = 5\u00a0mm"));
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
  std::string page = page_of(benchmark, {});
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
  EXPECT_TRUE(has(page_of(benchmark, {}), "1\u00a0kHz is not reached from 1,000 on."));
}

TEST(BenchmarkReport, HasChartsOfEveryMeshAndLinesOfEveryRule) {
  Benchmark benchmark = made_up_benchmark({51978, 985856});
  const std::size_t rows = benchmark.rows.size();
  for (std::size_t i = 0; i < rows; ++i) {
    benchmark.rows.push_back(benchmark.rows[i]);
    benchmark.rows.back().mesh = "skull";
    if (benchmark.rows[i].activation != "certified") continue;
    benchmark.rows.push_back(benchmark.rows[i]);
    benchmark.rows.back().activation = "all_faces";
  }
  const std::string page = page_of(benchmark, {});
  EXPECT_EQ(fault_in_html(page), "");
  EXPECT_EQ(how_many(page, "<h3>skull</h3>"), how_many(page, "<h3>bunny</h3>"));
  EXPECT_EQ(how_many(page, "<h3>skull</h3>"), 5U) << "in each section with charts";
  for (const char* rule : {"certified", "paper", "all_faces"}) {
    EXPECT_TRUE(has(page, std::string("<li>wide_bvh, ") + rule + ", active_set")) << rule;
  }
}

TEST(BenchmarkReport, IsOneWellFormedPageThatNeedsNothingElse) {
  const std::string page = page_of(made_up_benchmark(), made_up_comparison());
  EXPECT_EQ(fault_in_html(page), "");
  for (const char* reference : {"http:", "https:", "src=", "url(", "@import", "<script", "<link"}) {
    EXPECT_FALSE(has(page, reference)) << reference;
  }
  EXPECT_TRUE(has(page, "&lt;lost&gt; &quot;them&quot;"));
  EXPECT_TRUE(has(page, "AMD EPYC &lt;9R14&gt; &amp; &quot;friends&quot;"));
  EXPECT_TRUE(has(page, "XTOL_REACHED, &lt;wrong&gt; &amp; &quot;so&quot;"));
}

TEST(BenchmarkReport, EscapesEveryName) {
  const std::string hostile = "<i>&\"'";
  Benchmark benchmark = made_up_benchmark({51978, 985856});
  for (BenchmarkRow& row : benchmark.rows) {
    for (std::string* text : {&row.mesh, &row.index, &row.activation, &row.solver, &row.remark}) {
      *text += hostile;
    }
  }
  for (std::string* text :
       {&benchmark.date, &benchmark.command, &benchmark.machine.system, &benchmark.machine.compiler,
        &benchmark.machine.flags, &benchmark.machine.build_type, &benchmark.machine.keepout,
        &benchmark.machine.libraries.front()}) {
    *text += hostile;
  }
  Comparison comparison = made_up_comparison();
  for (IndexAgreement& row : comparison.indices) {
    for (std::string* text : {&row.mesh, &row.index, &row.activation}) *text += hostile;
  }
  for (SolverAgreement& row : comparison.solvers) {
    for (std::string* text : {&row.solver, &row.activation}) *text += hostile;
  }
  for (NarrowPhaseAgreement& row : comparison.narrow_phases) {
    for (std::string* text : {&row.backend, &row.tool, &row.relation}) *text += hostile;
  }
  const std::string page = page_of(benchmark, comparison);
  EXPECT_EQ(fault_in_html(page), "");
  EXPECT_FALSE(has(page, "<i>"));
  EXPECT_TRUE(has(page, "wide_bvh&lt;i&gt;&amp;&quot;&#39;"));
}

TEST(BenchmarkReport, ShowsEveryRow) {
  const Benchmark benchmark = made_up_benchmark();
  const std::string table = table_below(page_of(benchmark, {}), "Every row");
  EXPECT_EQ(how_many(table, "<tr>"), benchmark.rows.size() + 1);
  for (const MadeUpIndex& index : made_up_indices()) {
    EXPECT_TRUE(has(table, std::string(">") + index.name + "<")) << index.name;
  }
  for (const MadeUpSolver& solver : made_up_solvers()) {
    EXPECT_TRUE(has(table, std::string(">") + solver.name + "<")) << solver.name;
  }
}

TEST(BenchmarkReport, TellsWhereAllIndicesMadeTheSameSteps) {
  Benchmark benchmark = made_up_benchmark({51978});
  // Brute force was asked the first 200 motions only: of these 128 have a hash in common.
  EXPECT_TRUE(
      has(page_of(benchmark, {}),
          "in 8 groups, made the same steps in 8 of them, as far as they were asked for the "
          "same, the first 128 to 10,000 motions. Left out: 20 rows without such another."));
  benchmark.rows[2].hash ^= 1U;
  EXPECT_TRUE(has(page_of(benchmark, {}), "in 8 groups, made the same steps in 7 of them"));
  benchmark.rows[0].first_hashes[7] ^= 1U;
  EXPECT_TRUE(has(page_of(benchmark, {}), "in 8 groups, made the same steps in 7 of them"));
  benchmark.rows[0].verified = false;
  EXPECT_TRUE(has(page_of(benchmark, {}), "Left out: 1 row not verified."));
}

TEST(BenchmarkReport, ADashStandsForWhatIsMissing) {
  Benchmark benchmark = made_up_benchmark({985856});
  benchmark.rows.resize(2);
  benchmark.rows[0].step = made_up_timing(4.0, 50);  // too few for percentiles
  benchmark.rows[1].step = made_up_timing(5.0, 500);
  const std::string table = table_below(page_of(benchmark, {}), "Every row");
  EXPECT_TRUE(has(table, "<td>4.00</td><td>-</td><td>-</td><td>460</td>")) << table;
  EXPECT_TRUE(has(table, "<td>5.00</td><td>12.0</td><td>-</td><td>500</td>")) << table;
}

TEST(BenchmarkReport, TellsHowManyStepsWereWorse) {
  Benchmark benchmark = made_up_benchmark({985856});
  benchmark.rows.resize(2);
  benchmark.rows[0].worse_share = 0.125;
  benchmark.rows[1].queries = 0;
  const std::string table = table_below(page_of(benchmark, {}), "Every row");
  EXPECT_TRUE(has(table, ">worse [%]<")) << table;
  EXPECT_TRUE(has(table, "<td>" + mean_text(0.13) + "</td><td>" + mean_text(12.5) + "</td>"))
      << table;
  EXPECT_TRUE(has(table, "<td>0</td><td>-</td><td>-</td><td>-</td><td>-</td><td>-</td><td>-</td>"))
      << table;
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

/// All that is said on a page, without pictures and tables.
std::string words_of(std::string page) {
  const auto drop = [&](const std::string& from, const std::string& to) {
    for (std::size_t at; (at = page.find(from)) != std::string::npos;) {
      page.erase(at, page.find(to, at) + to.size() - at);
    }
  };
  drop("<svg", "</figure>");  // a picture may have others within
  drop("<table", "</table>");
  return page;
}

TEST(BenchmarkReport, PraisesNoRowThatGivesUp) {
  Benchmark benchmark = made_up_benchmark({985856});
  benchmark.rows.push_back(quitter(benchmark));
  const std::string page = sections_of(benchmark, {});
  EXPECT_EQ(fault_in_html(page_of(benchmark, {})), "");
  const std::string words = words_of(page);
  EXPECT_FALSE(has(words, "quick_index"));
  EXPECT_EQ(how_many(words, "quitter"), 1U);
  EXPECT_TRUE(has(
      words, "Shown, but not ranked: 1 row of quitter with more than 1 % of the steps without"));
  EXPECT_TRUE(has(words, "active_set finds the motion in"));
  EXPECT_FALSE(has(page, "quick_index, paper, quitter"));  // neither rates nor stages
  EXPECT_TRUE(has(page, ">quitter</text>"));               // the plot of solvers
  EXPECT_TRUE(has(table_below(page, "Every row"), ">quitter<"));

  benchmark.rows.back().unsolved_share = 0.01;
  EXPECT_TRUE(has(words_of(sections_of(benchmark, {})), "quitter finds the motion in"));
}

TEST(BenchmarkReport, SetsSolversAgainstEachOtherThatThePlotShowsWithAsManyPlanes) {
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
  const std::string page = words_of(page_of(benchmark, {}));
  EXPECT_TRUE(has(page,
                  "active_set finds the motion in 0.500\u00a0µs among 26.0 planes in the mean and "
                  "nlopt_mma finds the motion in 197\u00a0µs among 26.0 planes in the mean;"))
      << page;
  EXPECT_FALSE(has(page, "2.14"));
  // One that is given far fewer is not set against the others.
  std::erase_if(benchmark.rows, [](const BenchmarkRow& row) {
    return row.solver == "active_set" ? row.index != "wide_bvh" : row.solver == "nlopt_slsqp";
  });
  EXPECT_TRUE(has(words_of(page_of(benchmark, {})),
                  "nlopt_mma finds the motion in 197\u00a0µs among 26.0 planes in the mean, and no "
                  "other solver was given as many;"));
}

TEST(BenchmarkReport, OfOneIndexRanksNothing) {
  Benchmark benchmark;
  benchmark.rows = {duel().rows.front()};
  BenchmarkRow& row = benchmark.rows.front();
  row.build_s = 0.0122;
  row.build_cores = 0.31;
  row.bytes_per_triangle = 80.0;
  const std::string page = page_of(benchmark, {});
  EXPECT_TRUE(has(page,
                  "On ball with 1,000 triangles, wide_bvh is built in 0.0122 s with 0.31 cores "
                  "busy, and takes 80.0 bytes a triangle. Reading"))
      << words_of(page);
  EXPECT_FALSE(has(page, "slowest, in"));
  EXPECT_FALSE(has(page, "Left out:")) << "nothing was compared";
}

TEST(BenchmarkReport, SaysThatTimesToBuildOnABusyMachineIncludeWaiting) {
  Benchmark benchmark = made_up_benchmark({51978});
  benchmark.machine.cores = 2;
  benchmark.others_cores = 0.02;
  EXPECT_FALSE(has(page_of(benchmark, {}), "include waiting"));
  benchmark.others_cores = 1.7;
  EXPECT_TRUE(has(page_of(benchmark, {}), "times to build include waiting for a core"));
}

TEST(BenchmarkReport, LeavesOutRatesOfStepsThatTookNoTime) {
  Benchmark benchmark = made_up_benchmark({51978, 985856});
  for (BenchmarkRow& row : benchmark.rows) {
    if (row.index != "wide_bvh" || row.triangles > 100000) continue;
    row.collect->p50 = row.query->p50 = row.solve->p50 = row.step->p50 = 0.0;
  }
  const std::string page = page_of(benchmark, {});
  EXPECT_EQ(fault_in_html(page), "");
  EXPECT_FALSE(has(words_of(page), "inf"));
  EXPECT_FALSE(has(words_of(page), "nan"));
  for (BenchmarkRow& row : benchmark.rows) row.unsolved_share = 1.0;
  const std::string unranked = page_of(benchmark, {});
  EXPECT_EQ(fault_in_html(unranked), "");
  EXPECT_FALSE(has(unranked, "How often a step fits into a second"));
  EXPECT_FALSE(has(unranked, "Where the time of a step goes"));
  EXPECT_TRUE(has(unranked, "No row is ranked: none has triangles in reach and an answer to 99 %"));
}

TEST(BenchmarkReport, SaysHowItWasMeasured) {
  const std::string page = page_of(made_up_benchmark({985856}), {});
  EXPECT_TRUE(has(page, "a slow one is asked the first of them only"));
  EXPECT_TRUE(has(page, "held, bit for bit, to those of pd_tree with active_set"));
  EXPECT_TRUE(has(page, "NLopt's times include"));
  EXPECT_TRUE(has(page, "Solve is the search for the motion: the solver&#39;s work"));
  Benchmark ours = made_up_benchmark({985856});
  ours.rows.resize(1);
  EXPECT_FALSE(has(page_of(ours, {}), "NLopt's times include"));
}

TEST(BenchmarkReport, RowsThatWereNotTimedSayWhy) {
  Benchmark benchmark = made_up_benchmark({3943424});
  const std::string page = page_of(benchmark, {});
  const std::string table = table_below(page, "Every row");
  EXPECT_TRUE(has(table,
                  "<td>-</td><td>-</td><td>-</td><td>-</td><td>-</td><td>-</td><td>-</td>"
                  "<td>-</td><td>-</td><td class=\"words\">missed 3 triangles"));
  EXPECT_TRUE(has(page, "rows were not timed; the table of all rows says why."));
}

TEST(BenchmarkReport, EveryIndexHasALineAndEverySolverToo) {
  const std::string page = page_of(made_up_benchmark(), {});
  for (const MadeUpIndex& index : made_up_indices()) {
    // One in each of the four panels of a radius.
    EXPECT_GE(how_many(page, ">" + std::string(index.name) + "</text>"), 4U) << index.name;
  }
  for (const MadeUpSolver& solver : made_up_solvers()) {
    EXPECT_TRUE(has(page, ">" + std::string(solver.name) + "</text>")) << solver.name;
  }
}

TEST(BenchmarkReport, ShowsWhatThePaperPublished) {
  const std::string page = page_of(made_up_benchmark(), {});
  EXPECT_EQ(how_many(page, "<path class=\"mark series-published\""), 6U);  // 2 plots: 2 + legend
  EXPECT_TRUE(has(page, "7.73\u00a0kHz at 51,978"));
  EXPECT_TRUE(has(page, "0.18\u00a0kHz at 989,376"));
  EXPECT_TRUE(has(page, "i7-8700"));
  EXPECT_TRUE(has(page, "another machine. They state neither the motions nor the motion sphere"));
}

TEST(BenchmarkReport, OneSizeOfMeshIsShownWithoutLines) {
  const std::string page = page_of(made_up_benchmark({985856}), {});
  EXPECT_EQ(fault_in_html(page), "");
  EXPECT_FALSE(has(page, "class=\"leader series-0\" d=\"M66"));
  EXPECT_TRUE(has(page, "class=\"span "));
  EXPECT_TRUE(has(page, "Fastest at 985,856 triangles: wide_bvh, 7.73\u00a0µs."));
}

TEST(BenchmarkReport, LeavesOutWhatHasNoRows) {
  EXPECT_EQ(sections_of({}, {}), "");
  const std::string nothing = page_of({}, {});
  EXPECT_EQ(fault_in_html(nothing), "");
  EXPECT_TRUE(has(nothing, "<h1>Nothing was measured.</h1>"));
  EXPECT_FALSE(has(nothing, "<h2"));

  const std::string speed = page_of(made_up_benchmark({51978}), {});
  EXPECT_FALSE(has(speed, "agree?"));
  const std::string agreement = page_of({}, made_up_comparison());
  EXPECT_EQ(fault_in_html(agreement), "");
  EXPECT_TRUE(has(agreement,
                  "<h1>Of 80,000 queries, held to brute force one by one, "
                  "bullet_quantised missed 3 triangles; 2 steps differ"));
  EXPECT_FALSE(has(agreement, "Every row"));
  EXPECT_EQ(how_many(agreement, "agree?</h2>"), 3U);

  Benchmark untimed = made_up_benchmark({51978});
  for (BenchmarkRow& row : untimed.rows) {
    row.collect = row.query = row.step_query = row.activate = row.solve = row.step = std::nullopt;
    row.build_s = 0.0;
  }
  const std::string rows = page_of(untimed, {});
  EXPECT_EQ(fault_in_html(rows), "");
  EXPECT_EQ(how_many(rows, "<svg"), 0U);
  EXPECT_TRUE(has(rows, "No step was timed."));
}

TEST(BenchmarkReport, AgreementIsToldByName) {
  const std::string page = page_of({}, made_up_comparison());
  EXPECT_TRUE(has(page,
                  "nlopt_slsqp, nlopt_cobyla and nlopt_mma gave 21 answers that are wrong, and "
                  "nlopt_slsqp, nlopt_cobyla and nlopt_mma gave up 36 times."));
  EXPECT_TRUE(has(page, "; libccd_gjk, fcl_gjk and bullet_gjk did so "));
  EXPECT_TRUE(has(page, "Touching stands for a pair within 1e-6 mm of a touch"));
  EXPECT_TRUE(has(page, "4,700\u00a0× XTOL_REACHED, optimal; 181\u00a0× ROUNDOFF_LIMITED"));
}

TEST(BenchmarkReport, FollowsASimulationOnItsPage) {
  const Mesh mesh(tetrahedron());
  const Simulation simulation = tetrahedron_simulation(mesh);
  const auto with = [&](const Benchmark& benchmark, const Comparison& comparison) {
    std::ostringstream page;
    print_report(page, simulation, benchmark, comparison);
    return page.str();
  };
  const std::string page = with(made_up_benchmark({985856}), made_up_comparison());
  EXPECT_EQ(fault_in_html(page), "");
  EXPECT_LT(page.find("How this was measured"), page.find("<h2 class=\"part\">"));
  EXPECT_EQ(how_many(page, "<h1>"), 1U);
  std::ostringstream alone;
  print_report(alone, simulation);
  const std::string empty = with({}, {});
  const auto body = [](const std::string& text) { return text.substr(text.find("<body>")); };
  EXPECT_EQ(body(empty), body(alone.str()));
}

}  // namespace
}  // namespace keepout::app
