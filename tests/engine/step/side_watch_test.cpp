// SPDX-License-Identifier: BSD-3-Clause
// Tips that start on the forbidden side of a MotionConstraint.
#include "keepout/step/side_watch.h"

#include "keepout/factory/make_motion_constraint.h"
#include "keepout/oracle/safety_oracle.h"
#include "meshes.h"
#include "trials.h"

namespace keepout {
namespace {

// The cube's faces are at +-50.
MotionConstraint guard(const MotionConstraintSettings& settings = {}) {
  return make_motion_constraint(mesh_of("cube"), settings);
}

constexpr double recovery = 0.05;

TEST(SideWatch, ATipInsideIsLedOutWhateverItIsAskedFor) {
  auto constraint = guard();
  const Step step = constraint.step({.tip = {3, 4, 49}, .desired = {0.1, 0, -0.5}});
  EXPECT_EQ(step.status, Status::recovering);
  EXPECT_LT((step.motion - Vec3(0, 0, recovery)).norm(), 1e-12);
}

TEST(SideWatch, ARefusedCycleDoesNotMakeATipInsideAFreeOne) {
  auto constraint = guard();
  const Vec3 tip(3, 4, 49);
  EXPECT_EQ(constraint.step({.tip = tip, .desired = {100, 0, 0}}).status, Status::beyond_reach);
  EXPECT_EQ(constraint.step({.tip = tip, .desired = {0, 0, 0.1}}).status, Status::recovering);
  EXPECT_EQ(constraint.step({.tip = tip, .desired = {test::nan, 0, 0}}).status,
            Status::invalid_input);
  EXPECT_EQ(constraint.step({.tip = tip, .desired = {0, 0, 0.1}}).status, Status::recovering);
}

TEST(SideWatch, ATipThatTheCallerMovesInsideIsFound) {
  auto constraint = guard();
  EXPECT_EQ(constraint.step({.tip = {3, 4, 51}, .desired = {0, 0, -0.1}}).status, Status::free);
  EXPECT_EQ(constraint.step({.tip = {3, 4, 49}, .desired = {0, 0, -0.1}}).status,
            Status::recovering);
  EXPECT_EQ(constraint.step({.tip = {3, 4, 50.9}, .desired = {0, 0, -0.1}}).status, Status::free);
}

TEST(SideWatch, AfterARecoveryTheSurroundingsAreNotTakenForFree) {
  auto constraint = guard();  // of a margin of 0.2
  const Step step = constraint.step({.tip = {3, 4, 50.03}, .desired = {0, 0, -0.1}});
  ASSERT_EQ(step.status, Status::recovering);
  // Less than half of the margin away from the path of that step, but inside.
  const Step inside = constraint.step({.tip = {3, 4, 49.99}, .desired = {0, 0, -0.1}});
  EXPECT_EQ(inside.status, Status::recovering);
  EXPECT_GT(inside.motion.z(), 0.0);
}

TEST(SideWatch, ATipInAGapWithoutRoomEscapesOrSaysThatItDoesNot) {
  Surface surface = make_shape("cube");
  const auto first = static_cast<VertexId>(surface.vertices.size());
  for (const Vec3& corner : {Vec3(-9, -9, 50), Vec3(9, -9, 50), Vec3(0, 9, 50), Vec3(0, 0, 60)}) {
    surface.vertices.push_back(corner + Vec3(3, 4, 1e-9));
  }
  for (const Corners& c : {Corners{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}) {
    surface.triangles.push_back({c[0] + first, c[1] + first, c[2] + first});
  }
  int stuck = 0;
  for (int i = 0; i <= 40; ++i) {
    auto constraint = make_motion_constraint(mesh_of(surface), {});
    const Vec3 tip(3, 4, 50 + 2.5e-11 * i);
    const Step step = constraint.step({.tip = tip, .desired = {0, 0, 0.1}});
    EXPECT_EQ(step.ok(), !step.motion.isZero(0.0)) << i << ' ' << name(step.status);
    stuck += step.ok() ? 0 : 1;
  }
  EXPECT_GT(stuck, 5);
}

TEST(SideWatch, AfterForgettingATipIsPlacedAnewHoweverNear) {
  // A cube in a cube. Between them, the side depends on the nearer surface, unless a step has led
  // there.
  Surface nested = make_shape("cube");
  const Surface cube = nested;
  const auto first = static_cast<VertexId>(cube.vertices.size());
  for (const Vec3& v : cube.vertices) nested.vertices.push_back(0.1 * v);
  for (const Corners& c : cube.triangles) {
    nested.triangles.push_back({c[0] + first, c[1] + first, c[2] + first});
  }
  auto constraint = make_motion_constraint(mesh_of(nested), {});
  ASSERT_EQ(constraint.step({.tip = {3, 4, 26}, .desired = {0, 0, 4}}).status, Status::free);
  const Motion on{.tip = {3, 4, 30}, .desired = {0, 0, 0.1}};
  EXPECT_EQ(constraint.step(on).status, Status::free);
  constraint.forget();
  EXPECT_EQ(constraint.step(on).status, Status::inside);
}

TEST(SideWatch, TooDeepInsideNothingMovesByItself) {
  auto constraint = guard({.options = {.deepest = 2.0}});
  const Step deep = constraint.step({.tip = {3, 4, 47}, .desired = {0, 0, 0.1}});
  EXPECT_EQ(deep.status, Status::inside);
  EXPECT_EQ(deep.motion, Vec3::Zero());
  EXPECT_EQ(constraint.step({.tip = {3, 4, 48.5}, .desired = {0, 0, 0.1}}).status,
            Status::recovering);
}

TEST(SideWatch, WithJointsOrRowsOrWithoutRecoveryThereIsNoWayOut) {
  const TipJacobian::Matrix jacobian = TipJacobian::Matrix::Identity(3, 3);
  const Vec3 tip(3, 4, 49);
  auto constraint = guard();
  const Step joints = constraint.step({.tip = tip, .desired = {0, 0, 0.1}, .jacobian = jacobian});
  EXPECT_EQ(joints.status, Status::inside);
  EXPECT_EQ(joints.motion, Vec3::Zero());
  auto resting = guard({.options = {.recovery = 0.0}});
  EXPECT_EQ(resting.step({.tip = tip, .desired = {0, 0, 0.1}}).status, Status::inside);
}

TEST(SideWatch, OnTheSurfaceALargeMeshDoesNotTrapTheTip) {
  // The tolerance is larger than a ten-thousandth of the recovery.
  auto constraint = make_motion_constraint(mesh_of(enlarged(make_shape("cube"), 100.0)), {});
  Vec3 tip(3, 4, 5000);
  Status last = Status::unsolved;
  for (int cycle = 0; cycle < 20; ++cycle) {
    const Step step = constraint.step({.tip = tip, .desired = {0, 0, 0.01}});
    tip += step.motion;
    last = step.status;
  }
  EXPECT_EQ(last, Status::free);
  EXPECT_GT(tip.z(), 5000.2);
}

/// Tips of a campaign that are very close to the surface on the free side: too close for the
/// margin, but far enough for a side. The certified recovery must move them away, and never closer.
TEST(SideWatch, ATipAHairOffTheSurfaceComesNoNearer) {
  const auto mesh = mesh_of("cortex");
  oracle::SafetyOracle oracle(mesh);
  struct Case {
    Vec3 tip, desired;
    double radius, margin, recovery;
  };
  for (const Case& c : {Case{{28.37647126255659, 14.045841952296179, 26.139717798206284},
                             {0.01400350667982292, 0.023541901544377505, 0.013846586691919223},
                             0.31421561334628306,
                             0.3916155792446254,
                             0.016834889716285564},
                        Case{{28.37647126255659, 14.045841952296179, 26.139717798206284},
                             Vec3::Zero(),
                             5.0,
                             0.2,
                             2.5}}) {
    auto constraint = make_motion_constraint(
        mesh, {.options = {.radius = c.radius, .margin = c.margin, .recovery = c.recovery}});
    Vec3 tip = c.tip;
    for (int cycle = 0; cycle < 50; ++cycle) {
      const double before = oracle.distance(tip);
      const Step step = constraint.step({.tip = tip, .desired = c.desired});
      ASSERT_TRUE(step.ok()) << step.reason();
      const auto finding = oracle.check(tip, tip + step.motion, std::min(before, c.margin) - 1e-8);
      ASSERT_FALSE(finding.crosses || finding.below) << "cycle " << cycle;
      tip += step.motion;
    }
    EXPECT_GT(oracle.distance(tip), 1e-3);
  }
}

TEST(SideWatch, TakenAsItIsATipInsideIsKeptInside) {
  auto constraint = guard({.inside = Inside::taken_as_is});
  Vec3 tip(3, 4, 49);
  for (int cycle = 0; cycle < 20; ++cycle) {
    tip += constraint.step({.tip = tip, .desired = {0, 0, 0.5}}).motion;
  }
  EXPECT_NEAR(tip.z(), 49.8, 1e-7);
}

}  // namespace
}  // namespace keepout
