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
    return {{judged_psm(), arm_.chain().base(), {{tree_}}},
            arm_.chain(),
            random_,
            positions,
            options_,
            1e-9};
  }

  Instrument arm_ = psm({Vec3(0.3, 0.2, 120.0)});
  std::shared_ptr<const Mesh> mesh_ = mesh_of("flat_plate");
  std::shared_ptr<const TriangleTree> tree_ = std::make_shared<const TriangleTree>(mesh_);
  Random random_{1};
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

TEST_F(RobotJudgeOverAPlate, SeesBrokenLimitsOfJointsAndMotionsThatAreNone) {
  EXPECT_FALSE(judge_from(at(90.0, 1.5)).judge(at(90.0, 1.588)).limits_broken);
  EXPECT_TRUE(judge_from(at(90.0, 1.5)).judge(at(90.0, 1.589)).limits_broken);
  EXPECT_TRUE(judge_from(at(90.0)).judge(at(std::nan(""))).limits_broken);
  options_.period = 1e-3;
  EXPECT_TRUE(judge_from(at(90.0)).judge(at(90.0, 0.0011)).limits_broken);
}

}  // namespace
}  // namespace keepout::oracle
