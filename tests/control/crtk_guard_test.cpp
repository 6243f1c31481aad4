// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/crtk_guard.h"

#include <Eigen/Geometry>
#include <set>

#include "control/guarded_shapes.h"
#include "keepout/error.h"
#include "keepout/index/wide_bvh.h"
#include "messages.h"
#include "trials.h"

namespace keepout::test::crtk_guard {
namespace {
constexpr double accuracy = 1e-9;  // [m]

/// Returns the registration of a robot whose base is rotated, and 300 mm away from the mesh.
Registration registration() {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() =
      Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  matrix.topRightCorner<3, 1>() = Vec3(100, -250, 120);
  return Registration::mesh_from_robot(matrix, {.transform = LengthUnit::millimetre,
                                                .robot = LengthUnit::metre,
                                                .mesh = LengthUnit::millimetre});
}

const Mat3 tilted = Eigen::AngleAxisd(0.3, Vec3::UnitX()).toRotationMatrix();

/// Returns the pose of a point of the mesh in the robot's frame, in meters.
Pose pose_at(const Vec3& point_of_mesh, const Mat3& rotation = tilted) {
  return {registration().point_to_robot(point_of_mesh), rotation};
}

const Vec3 above(3, 4, top + 5.0);

class Crtk : public testing::Test {
 protected:
  static CrtkGuard make(const CrtkOptions& options = {}) {
    return {guard_of(cube()), registration(), options};
  }
  static CrtkGuard engaged(const CrtkOptions& options = {}) {
    CrtkGuard guard = make(options);
    EXPECT_EQ(guard.engage(pose_at(above)), CycleStatus::guarded);
    return guard;
  }
  /// Moves straight down to height z from where the guard was engaged.
  static void press(CrtkGuard& guard, double z, int cycles = 200) {
    for (int i = 1; i <= cycles; ++i) {
      guard.servo_cp(
          pose_at(above + (static_cast<double>(i) / cycles) * Vec3(0, 0, z - above.z())));
    }
  }
};

TEST_F(Crtk, AFreeGoalIsSentAsItIs) {
  CrtkGuard guard = engaged();
  const Mat3 other = Eigen::AngleAxisd(1.3, Vec3::UnitY()).toRotationMatrix();
  const Pose goal = pose_at(above + Vec3(0.1, 0, 0), other);
  EXPECT_EQ(guard.servo_cp(goal), CycleStatus::guarded);
  EXPECT_LT((guard.setpoint_cp()->position - goal.position).norm(), 1e-15);
  EXPECT_EQ(guard.setpoint_cp()->rotation, goal.rotation) << "to the last bit";
  EXPECT_EQ(guard.servo_cf().force, Vec3::Zero());
}

TEST_F(Crtk, AGoalBehindTheSurfaceIsHeldAtTheMarginAndTheHandFeelsIt) {
  CrtkGuard guard = engaged();
  press(guard, top + kept - 2.0);
  const Vec3 held(3, 4, top + kept);
  EXPECT_LT((guard.setpoint_cp()->position - pose_at(held).position).norm(), accuracy);
  EXPECT_EQ(guard.cycle().step, Status::limited);
  // 1 N/mm along the outward normal, in the robot's frame.
  const Vec3 expected = registration().force_to_robot({0, 0, 2.0});
  EXPECT_LT((guard.servo_cf().force - expected).norm(), 1e-6);
  EXPECT_EQ(guard.servo_cf().torque, Vec3::Zero());
}

TEST_F(Crtk, TheOrientationPassesThroughWhileTheTipIsHeld) {
  CrtkGuard guard = engaged();
  press(guard, top - 1.0);
  const Mat3 other = Eigen::AngleAxisd(-2.0, Vec3::UnitZ()).toRotationMatrix();
  EXPECT_EQ(guard.servo_cp(pose_at({3, 4, top - 1.0}, other)), CycleStatus::guarded);
  EXPECT_EQ(guard.setpoint_cp()->rotation, other);
}

TEST_F(Crtk, AScaledTeleoperationGivesTheHandWhatItPutsIn) {
  const Mat3 device = Eigen::AngleAxisd(0.5, Vec3::UnitZ()).toRotationMatrix();
  CrtkGuard guard = engaged({.motion_scale = 0.25, .hand_from_robot = device});
  press(guard, top + kept - 2.0);
  const Vec3 on_the_tool = registration().force_to_robot({0, 0, 2.0});
  EXPECT_LT((guard.servo_cf().force - 0.25 * (device * on_the_tool)).norm(), 1e-6);
}

TEST_F(Crtk, ADevicesFrameOfFourDigitsMakesTheForceNoLarger) {
  const Mat3 device = 1.00004 * Mat3::Identity();
  CrtkGuard guard =
      engaged({.haptic = {.spring = {.largest_force = 2.0}}, .hand_from_robot = device});
  press(guard, top + kept - 6.0);
  EXPECT_NEAR(guard.servo_cf().force.norm(), 2.0, 1e-12);
}

TEST_F(Crtk, WithoutEngagingThereIsNothingToSend) {
  CrtkGuard guard = make();
  EXPECT_EQ(guard.servo_cp(pose_at(above)), CycleStatus::not_engaged);
  EXPECT_EQ(guard.await_cp(), CycleStatus::not_engaged);
  EXPECT_FALSE(guard.setpoint_cp());
  EXPECT_EQ(guard.servo_cf().force, Vec3::Zero());
  guard.engage(pose_at(above));
  EXPECT_EQ(guard.setpoint_cp()->position, pose_at(above).position) << "no jump";
  press(guard, top - 1.0);
  guard.release();
  EXPECT_FALSE(guard.setpoint_cp());
  EXPECT_EQ(guard.servo_cf().force, Vec3::Zero());
  EXPECT_EQ(guard.servo_cp(pose_at(above)), CycleStatus::not_engaged);
}

TEST_F(Crtk, ClutchingStartsAnewWithoutForce) {
  CrtkGuard guard = engaged();
  press(guard, top + kept - 2.0);
  EXPECT_GT(guard.servo_cf().force.norm(), 1.9);
  const Pose robot = *guard.setpoint_cp();
  guard.release();
  // The operator has moved meanwhile. The teleoperation starts from the pose of the robot.
  EXPECT_EQ(guard.engage(robot), CycleStatus::guarded);
  EXPECT_EQ(guard.servo_cp(robot), CycleStatus::guarded);
  EXPECT_LT(guard.servo_cf().force.norm(), 1e-6);
  EXPECT_LT((guard.setpoint_cp()->position - robot.position).norm(), accuracy);
}

TEST_F(Crtk, AGoalInMillimetresIsRefused) {
  CrtkGuard guard = engaged();
  Pose goal = pose_at(above);
  goal.position *= 1000.0;
  EXPECT_EQ(guard.servo_cp(goal), CycleStatus::too_far);
  EXPECT_EQ(guard.setpoint_cp()->position, pose_at(above).position);
  EXPECT_EQ(guard.engage(goal), CycleStatus::far_from_mesh);
  EXPECT_FALSE(guard.setpoint_cp());
}

TEST_F(Crtk, AGoalThatIsNoPoseStopsTheRobotWithItsOrientation) {
  CrtkGuard guard = engaged();
  for (const Pose& goal :
       {Pose{{test::nan, 0, 0}, tilted}, pose_at(above, Mat3::Constant(test::nan)),
        pose_at(above, Mat3::Zero()), pose_at(above, -tilted)}) {
    EXPECT_EQ(guard.servo_cp(goal), CycleStatus::invalid_pose);
    EXPECT_EQ(guard.setpoint_cp()->position, pose_at(above).position);
    EXPECT_EQ(guard.setpoint_cp()->rotation, tilted);
    EXPECT_FALSE(guard.reason().empty());
  }
  EXPECT_EQ(guard.engage(pose_at(above, Mat3::Zero())), CycleStatus::invalid_pose);
}

TEST_F(Crtk, WithoutMessagesTheLastGoalStandsForAWhile) {
  CrtkGuard guard = engaged({.haptic = {.fade = 0.01}, .longest_silence = 0.02});
  press(guard, top + kept - 2.0);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(guard.await_cp(), CycleStatus::guarded) << i;
    EXPECT_NEAR(guard.servo_cf().force.norm(), 2.0, 1e-6);
  }
  const Pose held = *guard.setpoint_cp();
  for (int i = 1; i <= 20; ++i) {
    EXPECT_EQ(guard.await_cp(), CycleStatus::stale);
    EXPECT_NEAR(guard.servo_cf().force.norm(), std::max(0.0, 2.0 - 0.2 * i), 1e-6);
    EXPECT_EQ(guard.setpoint_cp()->position, held.position);
  }
  // Messages arrive again.
  EXPECT_EQ(guard.servo_cp(pose_at({3, 4, top + kept - 2.0})), CycleStatus::guarded);
}

TEST_F(Crtk, ARobotThatIsNotWhereItWasSentIsWaitedFor) {
  CrtkGuard guard = engaged({.farthest_lag = 2.0});
  guard.measured_cp(pose_at(above + Vec3(0, 0, 1.9)));
  EXPECT_EQ(guard.servo_cp(pose_at(above)), CycleStatus::guarded);
  guard.measured_cp(pose_at(above + Vec3(0, 0, 2.1)));
  EXPECT_EQ(guard.servo_cp(pose_at(above + Vec3(0.1, 0, 0))), CycleStatus::lagging);
  EXPECT_LT((guard.setpoint_cp()->position - pose_at(above).position).norm(), 1e-15);
  // Each measured pose is compared once only.
  EXPECT_EQ(guard.servo_cp(pose_at(above)), CycleStatus::guarded);
  guard.measured_cp({{test::nan, test::nan, test::nan}, tilted});
  EXPECT_EQ(guard.servo_cp(pose_at(above)), CycleStatus::invalid_pose);
}

TEST_F(Crtk, ARobotIsKeptInTheGuides) {
  const Guide corridor = Guide::point("corridor", Region::slab(above, Vec3::UnitX(), 1.0));
  CrtkGuard guard = engaged({.haptic = {.guides = {corridor}}});
  for (int i = 1; i <= 200; ++i) guard.servo_cp(pose_at(above + 0.02 * i * Vec3(1.0, 0.1, 0.0)));
  const Vec3 sent = registration().point_to_mesh(guard.setpoint_cp()->position);
  EXPECT_NEAR(corridor.region().excess(sent), 0.0, corridor.band() + 1e-9);
  EXPECT_NEAR(sent.y(), above.y() + 0.4, 1e-5) << "along the corridor it follows";
  EXPECT_TRUE(guard.cycle().limits.has(Limit::guide));
}

TEST_F(Crtk, ARobotStandsOnceTheMeshHasMoved) {
  const auto tree = std::make_shared<WideBvh>(cube());
  CrtkGuard guard(make_motion_constraint(cube(), tree, {.options = {.margin = kept}}),
                  registration(), {});
  guard.engage(pose_at(above));
  EXPECT_EQ(guard.servo_cp(pose_at(above)), CycleStatus::guarded);
  const Vec3 before = guard.setpoint_cp()->position;
  tree->refit(mesh_of(moved(make_cube(10.0), Vec3::UnitZ())));
  EXPECT_EQ(guard.servo_cp(pose_at(above + Vec3(0.1, 0, 0))), CycleStatus::stopped);
  EXPECT_EQ(guard.cycle().step, Status::mesh_changed);
  EXPECT_EQ(guard.setpoint_cp()->position, before);
}

TEST_F(Crtk, AnotherRegistrationIsTakenOnLettingGo) {
  CrtkGuard guard = engaged();
  const auto moved = Registration::mesh_from_robot(
      Eigen::Matrix4d::Identity(),
      {.transform = LengthUnit::metre, .robot = LengthUnit::metre, .mesh = LengthUnit::millimetre});
  guard.set_registration(moved);
  EXPECT_FALSE(guard.setpoint_cp());
  EXPECT_EQ(guard.servo_cp(pose_at(above)), CycleStatus::not_engaged);
  EXPECT_EQ(guard.engage({0.001 * above, tilted}), CycleStatus::guarded);
  EXPECT_EQ(guard.cycle().proxy, moved.point_to_mesh(0.001 * above));
}

TEST_F(Crtk, OptionsOutOfRangeAreRefused) {
  for (const double bad : {0.0, -1.0, test::nan}) {
    EXPECT_THROW(make({.motion_scale = bad}), Error);
    EXPECT_THROW(make({.farthest_lag = bad}), Error);
    EXPECT_THROW(make({.farthest_start = bad}), Error);
  }
  EXPECT_THROW(make({.longest_silence = test::nan}), Error);
  EXPECT_THROW(make({.hand_from_robot = -Mat3::Identity()}), Error);
  EXPECT_THROW(make({.hand_from_robot = 1000.0 * Mat3::Identity()}), Error);
  EXPECT_THROW(make({.haptic = {.period = 0.0}}), Error);
  EXPECT_EQ(error_of([&] { make({.motion_scale = -1.0}); }),
            "CRTK guard: motion_scale: expected a number above 0 and at most 1000, got -1");
}

TEST(CycleStatus, EachHasANameAndAReasonOfItsOwn) {
  std::set<std::string_view> names, reasons;
  for (int i = 0; i <= static_cast<int>(CycleStatus::stopped); ++i) {
    names.insert(name(static_cast<CycleStatus>(i)));
    reasons.insert(reason(static_cast<CycleStatus>(i)));
  }
  EXPECT_EQ(names.size(), 8u);
  EXPECT_EQ(reasons.size(), 8u);
  EXPECT_FALSE(names.contains("unknown"));
}

}  // namespace
}  // namespace keepout::test::crtk_guard
