// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/verdict.h"

#include <gtest/gtest.h>

#include <vector>

#include "keepout/error.h"
#include "messages.h"
#include "record/record.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "simulate/moments.h"
#include "simulate/simulation_json.h"
#include "simulation_scene.h"

namespace keepout::app {
namespace {

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
  const Simulation simulation = tetrahedron_simulation(mesh);
  std::vector<RunSummary> summaries;
  for (const app::Run& run : simulation.runs) summaries.push_back(summarize(run));
  EXPECT_CONTAINS(headline(simulation, summaries), "“leaky” let the tool into");
  EXPECT_CONTAINS(account(simulation, summaries), "0.0200\u00a0mm deep, in 1 of 1 stroke");
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
  EXPECT_EQ(worst_moment(simulation, 1).cycle, 40U);
  const Moment telling = telling_moment(simulation);
  EXPECT_EQ(telling.run, 2U) << "the rule that failed, though the tool went deeper without one";
  EXPECT_EQ(telling.cycle, 40U);
  simulation.runs.pop_back();
  EXPECT_EQ(telling_moment(simulation).run, 0U) << "no rule failed";
  simulation.runs[1].crossings = {{0, 7}};
  EXPECT_EQ(worst_moment(simulation, 1).cycle, 7U);
  EXPECT_EQ(telling_moment(simulation).run, 1U);
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
  const Mesh mesh(flat_ground());
  const Json record = record_of(slides(mesh, 0.0, SurfaceKind::open));
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
