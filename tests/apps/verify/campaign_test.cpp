// SPDX-License-Identifier: BSD-3-Clause
#include "verify/campaign.h"

#include "keepout/factory/make_motion_constraint.h"
#include "small_campaign.h"
#include "trials.h"
#include "verify/tip_joints.h"

namespace keepout::app {
namespace {

/// On the index that users get, which searches along the motion, and on one that is asked for
/// balls.
class CampaignOnIndex : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Indices, CampaignOnIndex, testing::Values("wide_bvh", "pd_tree"), by_name);

TEST_P(CampaignOnIndex, NoStepBreaksTheTheoremOnAnyGeneratedShape) {
  std::uint64_t told = 0;
  const std::vector<Arena> arenas = generated_arenas(GetParam());
  const Findings findings =
      run_campaign({.seed = 20261120, .steps = 200'000}, arenas, [&](std::uint64_t n, const auto&) {
        told += n;
        return Next::go_on;
      });
  for (const Json& breach : findings.breaches) ADD_FAILURE() << breach;
  const CampaignResult result = result_of({}, findings);
  const Json& sum = result.record["total"];
  EXPECT_FALSE(result.is_broken);
  EXPECT_EQ(sum["steps"], 200'000u);
  EXPECT_EQ(told, 200'000u);
  EXPECT_EQ(sum["trajectories"], 400u);
  EXPECT_EQ(findings.meshes.size(), shapes().size());
  // It is no walk in the park.
  EXPECT_GT(sum["statuses"]["limited"], 60'000u);
  EXPECT_GT(sum["statuses"]["free"], 20'000u);
  EXPECT_GT(sum["statuses"]["recovering"], 500u);
  EXPECT_GT(sum["led_out"], 50u);
  EXPECT_LT(sum["least_beyond_margin_in_tau"], -0.5);  // some go to where rounding counts
}

TEST(Campaign, TheSameSeedGivesTheSameAndAnotherSeedDoesNot) {
  const auto run = [](std::uint64_t seed) {
    return campaign_on("gear", {.seed = seed, .steps = 5'000}).meshes.front();
  };
  const Tally one = run(1);
  const Tally same = run(1);
  const Tally other = run(2);
  EXPECT_EQ(one.statuses, same.statuses);
  EXPECT_EQ(one.least, same.least);
  EXPECT_NE(one.statuses, other.statuses);
}

TEST(Campaign, AnUnevenNumberOfStepsIsDoneToTheLast) {
  const Findings findings = campaign_on("cube", {.steps = 1'234});
  EXPECT_EQ(findings.meshes.front().steps, 1'234u);
  EXPECT_EQ(findings.meshes.front().trajectories, 3u);
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
        make_motion_constraint(scene.mesh(), {.options = {.radius = setup.options.radius,
                                                          .tool_radius = setup.options.tool_radius,
                                                          .margin = setup.options.margin,
                                                          .damping = setup.options.damping,
                                                          .recovery = setup.options.recovery,
                                                          .deepest = setup.options.deepest,
                                                          .refinements = setup.options.refinements,
                                                          .nodes = setup.options.nodes,
                                                          .query = setup.options.query},
                                              .inside = setup.inside});
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

}  // namespace
}  // namespace keepout::app
