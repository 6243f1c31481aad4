// SPDX-License-Identifier: BSD-3-Clause
// No campaign finds a breach, with tips or with instruments.

#include "verify/campaign.h"

#include <utility>

#include "keepout/error.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/real_mesh.h"
#include "small_campaign.h"
#include "trials.h"
#include "verify/tip_joints.h"

namespace keepout::app {
namespace {

using oracle::Breach;

/// On the default index, which is traversed along the motion, and on one that is queried for balls.
class CampaignOnIndex : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Indices, CampaignOnIndex, testing::Values("wide_bvh", "pd_tree"), by_name);

TEST_P(CampaignOnIndex, NoStepBreaksTheTheoremOnAnyGeneratedShape) {
  std::uint64_t reported = 0;
  const std::vector<Arena> arenas = generated_arenas(GetParam());
  const Findings findings =
      run_campaign({.steps = 200'000, .seed = 20261120}, arenas, [&](std::uint64_t n, const auto&) {
        reported += n;
        return Next::go_on;
      });
  for (const Json& breach : findings.breaches) ADD_FAILURE() << breach;
  const CampaignResult result = result_of({}, findings);
  const Json& sum = result.record["total"];
  EXPECT_FALSE(result.is_broken);
  EXPECT_EQ(sum["steps"], 200'000u);
  EXPECT_EQ(reported, 200'000u);
  EXPECT_EQ(sum["trajectories"], 400u);
  EXPECT_EQ(findings.rows.size(), shapes().size());
  // The campaign must be hard enough.
  EXPECT_GT(sum["statuses"]["limited"], 60'000u);
  EXPECT_GT(sum["statuses"]["free"], 20'000u);
  EXPECT_GT(sum["statuses"]["recovering"], 500u);
  EXPECT_GT(sum["led_out"], 50u);
  EXPECT_LT(sum["least_beyond_margin_in_tau"], -0.5);  // some steps end where rounding matters
}

TEST(Campaign, TheSameSeedGivesTheSameAndAnotherSeedDoesNot) {
  for (Campaign campaign :
       {Campaign{.steps = 5'000}, Campaign{.robot = "psm", .cycles = 600, .speeds = {5.0}}}) {
    SCOPED_TRACE(campaign.robot);
    const auto run = [&](std::uint64_t seed) {
      campaign.seed = seed;
      return campaign_on("gear", campaign).rows.front();
    };
    const Tally one = run(1), same = run(1), other = run(2);
    EXPECT_EQ(one.statuses, same.statuses);
    EXPECT_EQ(one.least_beyond, same.least_beyond);
    EXPECT_NE(one.statuses, other.statuses);
    EXPECT_NE(one.least_beyond, other.least_beyond);
  }
}

TEST(Campaign, AnUnevenNumberOfStepsIsDoneToTheLast) {
  const Tally row = campaign_on("cube", {.steps = 1'234}).rows.front();
  EXPECT_EQ(row.cycles, 1'234u);
  EXPECT_EQ(row.starts, 3u);
}

TEST(Campaign, EachTipIsGuardedAsByAMotionConstraintOfItsOwn) {
  Scene scene("star_bumps", make_shape("star_bumps"), "wide_bvh");
  Guard guard(scene);
  Random random(7);
  std::size_t limited = 0;
  std::size_t recovering = 0;
  for (int i = 0; i < 120; ++i) {
    const app::Setup setup = draw_setup(scene, random);
    Attacker attacker(scene, random, setup.route, setup.longest_step,
                      required_clearance(setup.options));
    TipJoints joints(setup, random);
    guard.begin(setup.options, setup.inside);
    MotionConstraint constraint =
        make_motion_constraint(scene.mesh(), {.options = setup.options, .inside = setup.inside});
    Vec3 tip = setup.tip;
    for (int cycle = 0; cycle < 60; ++cycle) {
      Motion motion{.tip = tip, .desired = attacker.next(tip).linear};
      joints.attach(motion);
      const Step own = guard.step(motion);
      const Step theirs = constraint.step(motion);
      ASSERT_EQ(own.status, theirs.status);
      ASSERT_EQ(own.motion, theirs.motion);
      limited += own.status == Status::limited;
      recovering += own.status == Status::recovering;
      tip += own.motion;
    }
  }
  EXPECT_GT(limited, 2'000u);
  EXPECT_GT(recovering, 20u);
}

TEST(Campaign, ToolsOfAllRadiiAreDrawn) {
  Scene scene("cortex", make_shape("cortex"), "wide_bvh");
  Random random(8);
  int points = 0, balls = 0, without_margin = 0;
  for (int i = 0; i < 400; ++i) {
    const StepOptions options = draw_setup(scene, random).options;
    EXPECT_GE(options.margin, 0.0);
    EXPECT_GE(required_clearance(options),
              least_distance_kept(scene, options.radius) * (1.0 - 1e-15));
    points += options.tool_radius == 0.0;
    balls += options.tool_radius > 0.0 && options.margin > 0.0;
    without_margin += options.margin == 0.0;
  }
  EXPECT_GT(points, 100);
  EXPECT_GT(balls, 100);
  EXPECT_GT(without_margin, 10);
}

class RobotCampaignWith : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Robots, RobotCampaignWith, testing::Values("psm", "seven_joint_arm"),
                         by_name);

TEST_P(RobotCampaignWith, NoCycleComesTooCloseOrBreaksAJointsLimit) {
  std::vector<Arena> arenas{arena_of("cortex"), arena_of("thin_plates"), arena_of("crown")};
  try {
    fixture_path("airway");
    arenas.push_back(named_arena("airway", "wide_bvh"));
  } catch (const Error&) {  // it is not in the cache
  }
  const Findings findings =
      run_campaign({.robot = GetParam(), .cycles = 1000, .seed = 20261123}, arenas, go_on);
  EXPECT_TRUE(findings.is_complete);
  EXPECT_EQ(findings.rows.size(), 5 * arenas.size());
  Tally sum;
  for (const Tally& row : findings.rows) {
    const std::string where = row.mesh + ", " + row.scenario;
    EXPECT_EQ(row[Breach::too_near], 0u) << where << ": " << row.least_beyond;
    EXPECT_EQ(row[Breach::limits_broken], 0u) << where;
    EXPECT_TRUE(row.cycles == 1000u || row.startless > 0) << where;
    for (auto count :
         {&Tally::cycles, &Tally::blocked, &Tally::rows, &Tally::recoveries, &Tally::samples}) {
      sum.*count += row.*count;
    }
  }
  // The campaigns must be hard enough.
  EXPECT_GT(sum.cycles, 4000 * arenas.size());
  EXPECT_GT(sum.blocked, 100 * arenas.size());
  EXPECT_GT(sum.rows, 1000 * arenas.size());
  EXPECT_GT(sum.recoveries, 0u);
  EXPECT_GT(sum.samples, 0u);
}

// A step that stands still although a motion is allowed is safe, but useless. The judge searches
// for such a motion in every blocked cycle.
TEST(Campaign, BlockedCyclesOnHostileMeshesAreBlocked) {
  std::uint64_t samples = 0, movable = 0;
  for (const std::uint64_t seed : {1u, 70000u}) {
    if (seed != 1u && !test::all_trials()) break;
    const Findings findings = run_campaign({.scenarios = {"approach", "blade"},
                                            .cycles = test::trials(std::uint64_t{300}),
                                            .speeds = {1.0},
                                            .searched = 1,
                                            .seed = seed},
                                           hostile_arenas("wide_bvh"), go_on);
    for (const Tally& row : findings.rows) {
      EXPECT_EQ(row.samples, row.blocked) << row.mesh;
      samples += row.samples;
      movable += row.movable;
    }
  }
  EXPECT_GT(samples, test::all_trials() ? 2000u : 150u);
  EXPECT_LE(movable, samples / 50);
}

class EveryScenario : public testing::TestWithParam<std::pair<const char*, const char*>> {};
INSTANTIATE_TEST_SUITE_P(
    Verify, EveryScenario,
    testing::Values(std::pair{"approach", "cone"}, std::pair{"approach", "sheets"},
                    std::pair{"guides", "soup"}, std::pair{"blade", "saddle"},
                    std::pair{"moving", "bowl"}, std::pair{"meshes", "fan"},
                    std::pair{"stuck", "saddle"}, std::pair{"unlimited", "saddle"},
                    std::pair{"tip_guides", "soup"}, std::pair{"convex_tool", "cone"}),
    [](const auto& row) { return std::string(row.param.first) + "_" + row.param.second; });

TEST_P(EveryScenario, KeepsWhatIsPromised) {
  const auto& [scenario, mesh] = GetParam();
  const std::uint64_t cycles = test::trials(std::uint64_t{2000});
  const Findings findings =
      campaign_on(mesh, {.scenarios = {scenario}, .cycles = cycles, .speeds = {1.0}});
  const Tally& row = findings.rows.at(0);
  EXPECT_EQ(row[Breach::too_near], 0u) << row.least_in_tau;
  EXPECT_EQ(row[Breach::guide_left], 0u) << row.least_guide_in_tau;
  EXPECT_EQ(row[Breach::limits_broken], 0u);
  EXPECT_EQ(row.cycles, cycles);
  EXPECT_GT(row.blocked, test::trials(20u)) << "hardly pressed on anything";
}

}  // namespace
}  // namespace keepout::app
