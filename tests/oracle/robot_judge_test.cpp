// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/judges/robot_judge.h"

#include <cmath>

#include "keepout/fixtures/robots.h"
#include "meshes.h"
#include "trials.h"

namespace keepout::oracle {
namespace {

/// A psm whose port is 120 mm above a plate. If it points straight down, its tip is 3.7 mm beyond
/// its insertion. The radius of the cutter is 1 mm.
class RobotJudgeOverAPlate : public testing::Test {
 protected:
  using Positions = std::array<double, 6>;

  static Positions at(double insertion, double yaw = 0.0) { return {yaw, 0.0, insertion}; }
  RobotJudge judge_from(const Positions& positions) {
    return {
        {judged_psm(), arm_.chain().base(), {{tree_}}}, arm_.chain(), positions, options_, 1e-9};
  }

  Instrument arm_ = psm({Vec3(0.3, 0.2, 120.0)});
  std::shared_ptr<const Mesh> mesh_ = mesh_of("flat_plate");
  std::shared_ptr<const TriangleTree> tree_ = std::make_shared<const TriangleTree>(mesh_);
  InstrumentOptions options_{.margin = 0.2, .band = 0.002, .period = 10.0};
};

TEST_F(RobotJudgeOverAPlate, SeesABodyInTheMeshAtTheEndOfACycle) {
  const RobotVerdict verdict = judge_from(at(100.0)).judge(at(116.0));
  EXPECT_TRUE(verdict.is_below);
  EXPECT_FALSE(verdict.limits_broken);
  EXPECT_NEAR(verdict.least, 120.0 - 119.7 - 1.0, 1e-12);
  EXPECT_NEAR(verdict.beyond, verdict.least - 0.198, 1e-12);
}

TEST_F(RobotJudgeOverAPlate, SeesABodyInTheMeshAmidACycleWhoseEndsAreClear) {
  RobotJudge judge = judge_from(at(119.0, -0.3));
  EXPECT_TRUE(judge.is_recovered());
  EXPECT_TRUE(judge.judge(at(119.0, 0.3)).is_below);
  EXPECT_TRUE(judge.is_recovered());
}

TEST_F(RobotJudgeOverAPlate, HoldsAMotionToWhatWasToBeKeptToTheLastDigits) {
  const double lowest = 120.0 - 3.7 - 1.0 - 0.198;
  EXPECT_FALSE(judge_from(at(100.0)).judge(at(lowest - 1e-9)).is_below);
  EXPECT_TRUE(judge_from(at(100.0)).judge(at(lowest + 1e-8)).is_below);
}

TEST_F(RobotJudgeOverAPlate, WhatIsTooCloseMayNotComeCloserThanItEverWas) {
  RobotJudge judge = judge_from(at(115.6));  // the plate is 0.3 inside the cutter
  EXPECT_FALSE(judge.is_recovered());
  EXPECT_FALSE(judge.judge(at(115.4)).is_below);
  EXPECT_FALSE(judge.judge(at(115.401)).is_below);  // closer by less than the band
  EXPECT_TRUE(RobotJudge(judge).judge(at(115.41)).is_below);
  EXPECT_FALSE(judge.judge(at(115.0)).is_below);
  EXPECT_TRUE(judge.is_recovered());
  options_.margin += 0.5;
  judge.follow(options_);
  EXPECT_FALSE(judge.is_recovered());
  EXPECT_FALSE(judge.judge(at(115.0)).is_below);  // a raised margin starts a recovery
}

// The jaw swings past a sharp peak. It is too close during a hundredth of the cycle only: not at
// the start, at the end, or at any middle of an eighth.
TEST_F(RobotJudgeOverAPlate, SeesADipThatIsHiddenBetweenSamples) {
  const JudgedRobot robot = judged_psm();
  const auto at_share = [](double s) { return at(100.0, -0.05 + 0.1 * s); };
  const double narrow = 0.4;  // fraction of the cycle
  const auto jaw =
      axis_of(robot.bodies.back(), place(robot, arm_.chain().base(), at_share(narrow)));
  const Vec3 peak = jaw.to - Vec3(0.0, 0.0, 1.0 + 0.198 - 2e-4);
  mesh_ =
      mesh_of({{peak, peak + Vec3(1.0, 0.0, -50.0), peak + Vec3(0.0, 1.0, -50.0)}, {{0, 1, 2}}});
  tree_ = std::make_shared<const TriangleTree>(mesh_);
  InstrumentOracle oracle(tree_, robot, arm_.chain().base());
  for (int i = 0; i <= 16; ++i) {
    oracle.move_to(at_share(i / 16.0));
    EXPECT_GT(oracle.clearance(1.0), 0.198) << i;
  }
  RobotJudge judge = judge_from(at_share(0.0));
  const RobotVerdict verdict = judge.judge(at_share(1.0));
  EXPECT_TRUE(verdict.is_below);
  EXPECT_NEAR(verdict.least, 0.198 - 2e-4, 1e-4);
  EXPECT_TRUE(judge.is_recovered());
}

/// A step that accepts each motion whose end is clear is caught where it cuts a corner.
TEST(RobotJudge, CatchesACertificateThatLooksAtEndsOnly) {
  const auto mesh = mesh_of("triangle_soup");
  const auto tree = std::make_shared<const TriangleTree>(mesh);
  const Instrument arm = psm({mesh->bounds().center() + Vec3(0.3, 0.2, 120.0)});
  const JudgedRobot robot = judged_psm();
  const InstrumentOptions options{.margin = 0.2, .band = 0.002, .period = 10.0};
  const double tolerance = 1e-9;
  InstrumentOracle oracle(tree, robot, arm.chain().base());
  std::vector<double> q{0.0, 0.0, 20.0, 0.0, 0.0, 0.0};
  oracle.move_to(q);
  ASSERT_GE(oracle.clearance(1.0), options.margin);
  RobotJudge judge({robot, arm.chain().base(), {{tree}}}, arm.chain(), q, options, tolerance);
  Random random(1);
  int below = 0, made = 0;
  for (int i = 0; i < test::trials(20'000); ++i) {
    std::vector<double> next = q;
    for (double& x : next) x = 0.9 * x + random.uniform(-0.2, 0.2);       // about 0
    next[2] = std::clamp(q[2] + random.uniform(-3.0, 5.0), 20.0, 120.0);  // towards the mesh
    oracle.move_to(next);
    if (!(oracle.clearance(1.0) >= options.margin)) continue;
    ++made;
    const RobotVerdict verdict = judge.judge(next);
    double least = test::infinity;
    for (int s = 0; s <= 64; ++s) {
      std::vector<double> between = q;
      for (std::size_t k = 0; k < q.size(); ++k) between[k] += s / 64.0 * (next[k] - q[k]);
      oracle.move_to(between);
      least = std::min(least, oracle.clearance(1.0));
    }
    EXPECT_FALSE(verdict.is_undecided);
    EXPECT_TRUE(verdict.is_below || least >= 0.198 - 4.0 * tolerance);
    EXPECT_TRUE(!verdict.is_below || verdict.least < 0.198);
    below += verdict.is_below ? 1 : 0;
    q = next;
  }
  EXPECT_GT(made, 100);
  EXPECT_GT(below, 10);
}

TEST_F(RobotJudgeOverAPlate, SeesBrokenLimitsOfJointsAndMotionsThatAreNone) {
  EXPECT_FALSE(judge_from(at(90.0, 1.5)).judge(at(90.0, 1.588)).limits_broken);
  EXPECT_TRUE(judge_from(at(90.0, 1.5)).judge(at(90.0, 1.589)).limits_broken);
  EXPECT_TRUE(judge_from(at(90.0)).judge(at(std::nan(""))).limits_broken);
  options_.period = 1e-3;
  EXPECT_TRUE(judge_from(at(90.0)).judge(at(90.0, 0.0011)).limits_broken);
}

}  // namespace
}  // namespace keepout::oracle
