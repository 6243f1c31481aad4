// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "simulation_scene.h"

namespace keepout::app {
namespace {

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

}  // namespace
}  // namespace keepout::app
