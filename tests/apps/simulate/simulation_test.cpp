// SPDX-License-Identifier: BSD-3-Clause
// Figures, sentences and moments of a simulation's record.
#include "simulate/simulation.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "keepout/error.h"
#include "messages.h"
#include "record/record.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "small_surfaces.h"

namespace keepout::app {
namespace {

Cycle cycle(const Vec3& tip, double clearance, float step_us = 0.0F,
            Outcome outcome = Outcome::moved_freely) {
  return {tip, tip, clearance, step_us, outcome};
}

/// A stroke straight down at (0.2, 0.2), from above the base of the tetrahedron to a given height.
/// Clearance is that to the base alone, which is the nearest face here.
Stroke plunge(double lowest) {
  Stroke stroke;
  for (int i = 0; i <= 40; ++i) {
    const double height = -0.4 + (lowest + 0.4) * i / 40.0;
    stroke.cycles.push_back(cycle({0.2, 0.2, height}, -height, i % 2 == 0 ? 2.0F : 4.0F));
  }
  return stroke;
}

/// The base of the tetrahedron is the plane z = 0; free space is below it.
Simulation tetrahedron_simulation(const Mesh& mesh) {
  Simulation simulation{.mesh_name = "<tetra> & \"friends\"", .mesh = &mesh, .margin = 0.05};
  simulation.runs.push_back({.rule = no_rule, .description = "", .strokes = {plunge(0.15)}});
  simulation.runs.push_back({.rule = "safe", .description = "a < b", .strokes = {plunge(-0.05)}});
  simulation.runs.push_back({.rule = "leaky", .description = "", .strokes = {plunge(0.02)}});
  simulation.settings = {{"seed", "<1>"}};
  return simulation;
}

TEST(Summary, FiguresAreThoseCountedByHand) {
  app::Run run{.rule = "some", .description = ""};
  Stroke outside, inside;
  for (int i = 1; i <= 8; ++i) {
    outside.cycles.push_back(cycle({0, 0, 0}, 0.5 * i, static_cast<float>(i), Outcome::limited));
  }
  inside.cycles = {cycle({0, 0, 0}, -0.25, 9.0F), cycle({0, 0, 0}, -1.5, 10.0F, Outcome::stopped)};
  run.strokes = {outside, inside};
  run.crossings = {{1, 0}};

  const RunSummary s = summarize(run);
  EXPECT_EQ(s.strokes, 2U);
  EXPECT_EQ(s.cycles, 10U);
  EXPECT_EQ(s.moved_freely, 1U);
  EXPECT_EQ(s.limited, 8U);
  EXPECT_EQ(s.stopped, 1U);
  EXPECT_EQ(s.p50_us, 5.0);
  EXPECT_EQ(s.p99_us, 10.0);
  EXPECT_EQ(s.p999_us, 10.0);
  EXPECT_EQ(s.max_us, 10.0);
  EXPECT_EQ(s.rate_khz, 200.0);
  EXPECT_EQ(s.closest_approach, 0.0);
  EXPECT_EQ(s.deepest_penetration, 1.5);
  EXPECT_EQ(s.cycles_inside, 2U);
  EXPECT_EQ(s.strokes_inside, 1U);
  EXPECT_EQ(s.strokes_breached, 1U);
  EXPECT_EQ(s.crossings, 1U);
  EXPECT_FALSE(s.kept_out());
}

TEST(Summary, ARunThatStaysOutsideTellsItsClosestApproach) {
  const RunSummary s = summarize({.rule = "some", .description = "", .strokes = {plunge(-0.05)}});
  EXPECT_DOUBLE_EQ(s.closest_approach, 0.05);
  EXPECT_EQ(s.deepest_penetration, 0.0);
  EXPECT_TRUE(s.kept_out());
}

TEST(Summary, AClearanceThatIsNotANumberCountsAgainstTheRule) {
  app::Run run{.rule = "some", .description = ""};
  run.strokes = {{{cycle({0, 0, 0}, std::numeric_limits<double>::quiet_NaN())}}};
  EXPECT_EQ(summarize(run).cycles_inside, 1U);
}

TEST(Summary, ARunThatCrossedAnOpenSurfaceCameAsNearAsCanBe) {
  app::Run run{.rule = "some", .description = ""};
  run.strokes = {{std::vector<Cycle>(5, cycle({0, 0, 0}, 0.108))}};
  EXPECT_EQ(summarize(run).closest_approach, 0.108);
  run.crossings = {{0, 1}};
  EXPECT_EQ(summarize(run).closest_approach, 0.0);
  EXPECT_EQ(summarize(run).deepest_penetration, 0.0);
}

TEST(Text, NumbersReadWell) {
  EXPECT_EQ(grouped(24000), "24,000");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(rounded(0.0012345), "0.00123");
  EXPECT_EQ(rounded(12.0), "12.0");
  EXPECT_EQ(trimmed(12.0), "12");
  EXPECT_EQ(trimmed(-0.5), "-0.5");
  EXPECT_EQ(trimmed(1200.0), "1200");
  EXPECT_EQ(trimmed(155.6996), "155.7");
  EXPECT_EQ(trimmed(1234567.8), "1234568");
  EXPECT_EQ(trimmed(-1e-17), "0");
  EXPECT_EQ(how_often(1), "once");
  EXPECT_EQ(how_often(2), "twice");
  EXPECT_EQ(how_often(1200), "1,200 times");
  EXPECT_EQ(length_text(1.2345), "1.23\u00a0mm");
  EXPECT_EQ(length_text(0.0012345), "1.23\u00a0µm");
  EXPECT_EQ(listed({"a", "b", "c"}), "a, b and c");
}

TEST(Verdict, NamesTheRulesThatFailAndHowDeep) {
  const Mesh mesh(tetrahedron());
  const Json record = record_of(tetrahedron_simulation(mesh));
  EXPECT_CONTAINS(record["headline"].get<std::string>(), "“leaky” let the tool into");
  EXPECT_CONTAINS(record["account"][0].get<std::string>(), "0.0200\u00a0mm deep, in 1 of 1 stroke");
}

TEST(Verdict, SaysIfARuleThatKeptTheToolOutTouchedOrCrossed) {
  app::Run run{.rule = "some", .description = ""};
  const auto outcome = [&](double clearance) {
    run.strokes = {{{cycle({0, 0, 0}, clearance)}}};
    return outcome_of(summarize(run), SurfaceKind::open);
  };
  EXPECT_CONTAINS(outcome(0.0), "touched");
  EXPECT_CONTAINS(outcome(9e-7), "touched");
  EXPECT_CONTAINS(outcome(2e-6), "2.00\u00a0nm");
  run.strokes = {{std::vector<Cycle>(5, cycle({0, 0, 0}, 1.0))}, {{cycle({0, 0, 0}, 1.0)}}};
  run.crossings = {{0, 1}};
  EXPECT_CONTAINS(outcome_of(summarize(run), SurfaceKind::open), "once, in 1 of 2 strokes");
}

TEST(Moments, AreTheDeepestOrElseTheFirstCrossingOrElseTheNearest) {
  const Mesh mesh(tetrahedron());
  Simulation simulation = tetrahedron_simulation(mesh);
  const auto worst_of_the_first_rule = [&] {
    return record_of(simulation)["runs"][1]["worst"]["cycle"].get<int>();
  };
  EXPECT_EQ(worst_of_the_first_rule(), 40);
  const Json telling = record_of(simulation)["moment"];
  EXPECT_EQ(telling["run"], 2) << "the rule that failed, though the tool went deeper without one";
  EXPECT_EQ(telling["cycle"], 40);
  simulation.runs.pop_back();
  EXPECT_EQ(record_of(simulation)["moment"]["run"], 0) << "no rule failed";
  simulation.runs[1].crossings = {{0, 7}};
  EXPECT_EQ(worst_of_the_first_rule(), 7);
  EXPECT_EQ(record_of(simulation)["moment"]["run"], 1);
}

TEST(SimulationRecord, HasEveryCycleAndWhatIsSaidOfIt) {
  const Mesh mesh(tetrahedron());
  const Simulation simulation = tetrahedron_simulation(mesh);
  const Json record = record_of(simulation);
  EXPECT_EQ(fault_of(record), "");
  EXPECT_EQ(record["moment"], (Json{{"run", 2}, {"stroke", 0}, {"cycle", 40}}));
  ASSERT_EQ(record["runs"].size(), 3U);
  for (std::size_t r = 0; r < 3; ++r) {
    const Json& run = record["runs"][r];
    const Json& stroke = run["strokes"][0];
    const std::vector<Cycle>& cycles = simulation.runs[r].strokes[0].cycles;
    ASSERT_EQ(stroke["tip"].size(), cycles.size());
    for (std::size_t c = 0; c < cycles.size(); ++c) {
      EXPECT_NEAR(stroke["tip"][c][2].get<double>(), cycles[c].tip.z(), 0.51e-6);
      EXPECT_NEAR(stroke["clearance_mm"][c].get<double>(), cycles[c].clearance, 0.51e-6);
      EXPECT_TRUE(r > 0 || record["hand"][0][c] == stroke["tip"][c]) << "without a fixture";
    }
    EXPECT_EQ(stroke["outcome"], std::string(cycles.size(), 'f'));
    const RunSummary summary = summarize(simulation.runs[r]);
    EXPECT_EQ(run["kept_out"], summary.kept_out());
    EXPECT_EQ(run["words"], outcome_of(summary, simulation.surface));
    EXPECT_EQ(run["summary"]["cycles_inside"], summary.cycles_inside);
    EXPECT_EQ(run["summary"]["p50_us"], summary.p50_us);
  }
  EXPECT_TRUE(record["benchmark"].is_null());
}

TEST(SimulationRecord, OfAnOpenSurfaceTellsOfNoInside) {
  const Mesh mesh(tetrahedron());
  Simulation simulation = tetrahedron_simulation(mesh);
  simulation.surface = SurfaceKind::open;
  const Json record = record_of(simulation);
  EXPECT_EQ(record["mesh"]["surface"], "open");
  EXPECT_TRUE(record["runs"][0]["summary"]["cycles_inside"].is_null());
  EXPECT_TRUE(record["runs"][0]["summary"]["deepest_mm"].is_null());
}

TEST(SimulationRecord, RefusesWhatItCannotTell) {
  const Mesh mesh(tetrahedron());
  Simulation simulation = tetrahedron_simulation(mesh);
  simulation.runs[1].strokes.clear();
  EXPECT_THROW(record_of(simulation), Error);
  simulation.runs.clear();
  EXPECT_THROW(record_of(simulation), Error);
}

}  // namespace
}  // namespace keepout::app
