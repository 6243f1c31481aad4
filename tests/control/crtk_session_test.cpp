// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/crtk_session.h"

#include <Eigen/Geometry>
#include <set>

#include "control/guarded_shapes.h"
#include "keepout/error.h"
#include "keepout/index/wide_bvh.h"
#include "messages.h"
#include "trials.h"

namespace keepout::test::crtk_session {
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

/// A session of a tip with a simulated clock and a robot that reports what it does.
class Loop {
 public:
  explicit Loop(const CrtkOptions& options = {})
      : session(guard_of(cube()), registration(), options) {}

  /// Reports a robot that is enabled, homed, and at a pose.
  void report(const Pose& robot) {
    session.on_operating_state(OperatingState::enabled, true);
    session.on_measured_cp(robot, {now});
    session.on_setpoint_cp(robot, {now});
  }
  CycleStatus engage(const Pose& robot) {
    report(robot);
    return session.engage(now);
  }
  /// Runs a period without a message of the operator. The robot follows its setpoint exactly.
  CycleStatus wait() {
    now += 0.001;
    if (session.setpoint_cp()) session.on_measured_cp(*session.setpoint_cp(), {now});
    return session.tick(now);
  }
  CycleStatus servo_cp(const Pose& goal) {
    session.on_servo_cp(goal, {now + 0.001});
    return wait();
  }
  /// Moves straight down to height z from where the session was engaged.
  void press(double z, int cycles = 200) {
    for (int i = 1; i <= cycles; ++i) {
      servo_cp(pose_at(above + (static_cast<double>(i) / cycles) * Vec3(0, 0, z - above.z())));
    }
  }

  CrtkSession session;
  double now = 100.0;  // [s]
};

class Crtk : public testing::Test {
 protected:
  static Loop engaged(const CrtkOptions& options = {}) {
    Loop loop(options);
    EXPECT_EQ(loop.engage(pose_at(above)), CycleStatus::guarded);
    return loop;
  }
};

TEST_F(Crtk, AFreeGoalIsSentAsItIs) {
  Loop loop = engaged();
  const Mat3 other = Eigen::AngleAxisd(1.3, Vec3::UnitY()).toRotationMatrix();
  const Pose goal = pose_at(above + Vec3(0.1, 0, 0), other);
  EXPECT_EQ(loop.servo_cp(goal), CycleStatus::guarded);
  EXPECT_LT((loop.session.setpoint_cp()->position - goal.position).norm(), 1e-15);
  EXPECT_EQ(loop.session.setpoint_cp()->rotation, goal.rotation) << "to the last bit";
  EXPECT_EQ(loop.session.servo_cf().force, Vec3::Zero());
}

TEST_F(Crtk, AGoalBehindTheSurfaceIsHeldAtTheMarginAndTheHandFeelsIt) {
  Loop loop = engaged();
  loop.press(top + kept - 2.0);
  const Vec3 held(3, 4, top + kept);
  EXPECT_LT((loop.session.setpoint_cp()->position - pose_at(held).position).norm(), accuracy);
  EXPECT_EQ(loop.session.cycle().step, Status::limited);
  // 1 N/mm along the outward normal, in the robot's frame.
  const Vec3 expected = registration().force_to_robot({0, 0, 2.0});
  EXPECT_LT((loop.session.servo_cf().force - expected).norm(), 1e-6);
  EXPECT_EQ(loop.session.servo_cf().torque, Vec3::Zero());
}

TEST_F(Crtk, TheOrientationPassesThroughWhileTheTipIsHeld) {
  Loop loop = engaged();
  loop.press(top - 1.0);
  const Mat3 other = Eigen::AngleAxisd(-2.0, Vec3::UnitZ()).toRotationMatrix();
  EXPECT_EQ(loop.servo_cp(pose_at({3, 4, top - 1.0}, other)), CycleStatus::guarded);
  EXPECT_EQ(loop.session.setpoint_cp()->rotation, other);
}

TEST_F(Crtk, AScaledTeleoperationGivesTheHandWhatItPutsIn) {
  const Mat3 device = Eigen::AngleAxisd(0.5, Vec3::UnitZ()).toRotationMatrix();
  Loop loop = engaged({.motion_scale = 0.25, .hand_from_robot = device});
  loop.press(top + kept - 2.0);
  const Vec3 on_the_tool = registration().force_to_robot({0, 0, 2.0});
  EXPECT_LT((loop.session.servo_cf().force - 0.25 * (device * on_the_tool)).norm(), 1e-6);
}

TEST_F(Crtk, ADevicesFrameOfFourDigitsMakesTheForceNoLarger) {
  const Mat3 device = 1.00004 * Mat3::Identity();
  Loop loop = engaged({.haptic = {.spring = {.largest_force = 2.0}}, .hand_from_robot = device});
  loop.press(top + kept - 6.0);
  EXPECT_NEAR(loop.session.servo_cf().force.norm(), 2.0, 1e-12);
}

TEST_F(Crtk, WithoutEngagingThereIsNothingToSend) {
  Loop loop;
  loop.session.on_operating_state(OperatingState::enabled, true);
  EXPECT_EQ(loop.servo_cp(pose_at(above)), CycleStatus::not_engaged);
  EXPECT_EQ(loop.wait(), CycleStatus::not_engaged);
  EXPECT_FALSE(loop.session.setpoint_cp());
  EXPECT_EQ(loop.session.servo_cf().force, Vec3::Zero());
  loop.engage(pose_at(above));
  EXPECT_EQ(loop.session.setpoint_cp()->position, pose_at(above).position) << "no jump";
  loop.press(top - 1.0);
  loop.session.release();
  EXPECT_FALSE(loop.session.setpoint_cp());
  EXPECT_EQ(loop.session.servo_cf().force, Vec3::Zero());
  EXPECT_EQ(loop.servo_cp(pose_at(above)), CycleStatus::not_engaged);
}

TEST_F(Crtk, ClutchingStartsAnewWithoutForce) {
  Loop loop = engaged();
  loop.press(top + kept - 2.0);
  EXPECT_GT(loop.session.servo_cf().force.norm(), 1.9);
  const Pose robot = *loop.session.setpoint_cp();
  loop.session.release();
  // The operator has moved meanwhile. The teleoperation starts from the pose of the robot.
  EXPECT_EQ(loop.engage(robot), CycleStatus::guarded);
  EXPECT_EQ(loop.servo_cp(robot), CycleStatus::guarded);
  EXPECT_LT(loop.session.servo_cf().force.norm(), 1e-6);
  EXPECT_LT((loop.session.setpoint_cp()->position - robot.position).norm(), accuracy);
}

TEST_F(Crtk, AGoalInMillimetresIsRefused) {
  Loop loop = engaged();
  Pose goal = pose_at(above);
  goal.position *= 1000.0;
  EXPECT_EQ(loop.servo_cp(goal), CycleStatus::too_far);
  EXPECT_EQ(loop.session.setpoint_cp()->position, pose_at(above).position);
  EXPECT_EQ(loop.engage(goal), CycleStatus::far_from_mesh);
  EXPECT_FALSE(loop.session.setpoint_cp());
}

TEST_F(Crtk, AGoalThatIsNoPoseStopsTheRobotWithItsOrientation) {
  Loop loop = engaged();
  for (const Pose& goal :
       {Pose{{test::nan, 0, 0}, tilted}, pose_at(above, Mat3::Constant(test::nan)),
        pose_at(above, Mat3::Zero()), pose_at(above, -tilted)}) {
    EXPECT_EQ(loop.servo_cp(goal), CycleStatus::invalid_pose);
    EXPECT_EQ(loop.session.setpoint_cp()->position, pose_at(above).position);
    EXPECT_EQ(loop.session.setpoint_cp()->rotation, tilted);
    EXPECT_FALSE(loop.session.reason().empty());
  }
  EXPECT_EQ(loop.engage(pose_at(above, Mat3::Zero())), CycleStatus::invalid_pose);
}

TEST_F(Crtk, WithoutMessagesTheLastGoalStandsForAWhile) {
  Loop loop = engaged({.haptic = {.fade = 0.01}, .longest_silence = 0.02});
  loop.press(top + kept - 2.0);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(loop.wait(), CycleStatus::guarded) << i;
    EXPECT_NEAR(loop.session.servo_cf().force.norm(), 2.0, 1e-6);
  }
  const Pose held = *loop.session.setpoint_cp();
  for (int i = 1; i <= 20; ++i) {
    EXPECT_EQ(loop.wait(), CycleStatus::stale);
    EXPECT_NEAR(loop.session.servo_cf().force.norm(), std::max(0.0, 2.0 - 0.2 * i), 1e-6);
    EXPECT_EQ(loop.session.setpoint_cp()->position, held.position);
  }
  // Messages arrive again.
  EXPECT_EQ(loop.servo_cp(pose_at({3, 4, top + kept - 2.0})), CycleStatus::guarded);
}

TEST_F(Crtk, ARobotThatIsNotWhereItWasSentIsWaitedFor) {
  Loop loop = engaged({.farthest_lag = 2.0});
  const auto tick_measured = [&](const Pose& measured) {
    loop.now += 0.001;
    loop.session.on_measured_cp(measured, {loop.now});
    loop.session.on_servo_cp(pose_at(above + Vec3(0.1, 0, 0)), {loop.now});
    return loop.session.tick(loop.now);
  };
  EXPECT_EQ(tick_measured(pose_at(above + Vec3(0, 0, 1.9))), CycleStatus::guarded);
  const Vec3 before = loop.session.setpoint_cp()->position;
  EXPECT_EQ(tick_measured(pose_at(above + Vec3(0, 0, 2.1))), CycleStatus::lagging);
  EXPECT_EQ(loop.session.setpoint_cp()->position, before);
  EXPECT_EQ(tick_measured(pose_at(above)), CycleStatus::guarded);
  EXPECT_EQ(tick_measured({{test::nan, test::nan, test::nan}, tilted}), CycleStatus::invalid_pose);
}

TEST_F(Crtk, ARobotThatIsNotReadyIsReleased) {
  Loop loop;
  EXPECT_EQ(loop.session.tick(loop.now), CycleStatus::not_ready) << "nothing is known of the robot";
  EXPECT_EQ(loop.session.engage(loop.now), CycleStatus::not_ready);
  EXPECT_EQ(loop.session.operating_state(), OperatingState::disabled);
  for (const auto& [state, is_homed] : {std::pair{OperatingState::enabled, false},
                                        {OperatingState::disabled, true},
                                        {OperatingState::paused, true},
                                        {OperatingState::fault, true}}) {
    EXPECT_EQ(loop.engage(pose_at(above)), CycleStatus::guarded);
    EXPECT_EQ(loop.session.operating_state(), OperatingState::enabled);
    loop.session.on_operating_state(state, is_homed);
    EXPECT_EQ(loop.servo_cp(pose_at(above)), CycleStatus::not_ready) << name(state);
    EXPECT_FALSE(loop.session.setpoint_cp()) << "nothing is sent to it";
    EXPECT_NE(loop.session.operating_state(), OperatingState::enabled);
    EXPECT_EQ(loop.session.engage(loop.now), CycleStatus::not_ready);
    loop.session.on_operating_state(OperatingState::enabled, true);
    EXPECT_EQ(loop.servo_cp(pose_at(above)), CycleStatus::not_engaged) << "it does not go on alone";
  }
  EXPECT_EQ(loop.session.operating_state(), OperatingState::paused);
}

TEST_F(Crtk, ARobotThatIsNoLongerMeasuredIsNotMoved) {
  Loop loop = engaged();
  const auto tick_unmeasured = [&] {
    loop.now += 0.001;
    loop.session.on_servo_cp(pose_at(above), {loop.now});
    return loop.session.tick(loop.now);
  };
  for (int i = 0; i < 20; ++i) EXPECT_EQ(tick_unmeasured(), CycleStatus::guarded) << i;
  EXPECT_EQ(tick_unmeasured(), CycleStatus::unmeasured);
  EXPECT_EQ(loop.session.engage(loop.now), CycleStatus::unmeasured) << "its setpoint is old too";
  Loop patient({.longest_silence = std::numeric_limits<double>::infinity()});
  patient.session.on_operating_state(OperatingState::enabled, true);
  EXPECT_EQ(patient.session.engage(patient.now), CycleStatus::unmeasured) << "nothing arrived";
  patient.session.on_setpoint_cp(pose_at(above), {patient.now});
  EXPECT_EQ(patient.session.engage(patient.now), CycleStatus::guarded);
  EXPECT_EQ(patient.session.tick(patient.now), CycleStatus::unmeasured);
  Loop blind({.needs_feedback = false});
  blind.session.on_setpoint_cp(pose_at(above), {blind.now});
  EXPECT_EQ(blind.session.engage(blind.now), CycleStatus::guarded);
  blind.now += 0.001;
  blind.session.on_servo_cp(pose_at(above), {blind.now});
  EXPECT_EQ(blind.session.tick(blind.now), CycleStatus::guarded);
}

TEST_F(Crtk, AStampThatIsOldOrAheadIsStale) {
  for (const double age : {0.0211, -0.0211, 1e9, -1e9, test::nan}) {
    Loop loop = engaged();
    loop.session.on_servo_cp(pose_at(above), {loop.now + 0.001 - age});
    EXPECT_EQ(loop.wait(), CycleStatus::stale) << age;
    EXPECT_EQ(loop.session.setpoint_cp()->position, pose_at(above).position);
    EXPECT_EQ(loop.servo_cp(pose_at(above)), CycleStatus::guarded) << "the next one is fresh";
  }
}

TEST_F(Crtk, AnotherFrameStopsTheRobot) {
  Loop loop = engaged({.frame = "PSM1_base"});
  const auto tick_in = [&](std::string_view frame) {
    loop.session.on_servo_cp(pose_at(above), {loop.now + 0.001, frame});
    return loop.wait();
  };
  EXPECT_EQ(tick_in("PSM1_base"), CycleStatus::guarded);
  EXPECT_EQ(tick_in("camera"), CycleStatus::other_frame);
  EXPECT_EQ(tick_in(""), CycleStatus::guarded) << "not stated";
  loop.session.on_measured_cp(pose_at(above), {loop.now, "camera"});
  EXPECT_EQ(tick_in("PSM1_base"), CycleStatus::other_frame);
}

TEST_F(Crtk, ARefusedMessageStopsTheRobotAlsoIfAGoodOneFollows) {
  Loop loop = engaged();
  loop.session.on_servo_cp({{test::nan, 0, 0}, tilted}, {loop.now + 0.001});
  EXPECT_EQ(loop.servo_cp(pose_at(above + Vec3(0.1, 0, 0))), CycleStatus::invalid_pose);
  EXPECT_EQ(loop.session.setpoint_cp()->position, pose_at(above).position);
  loop.session.refuse(CycleStatus::wrong_command);
  loop.session.refuse(CycleStatus::other_frame);
  EXPECT_EQ(loop.servo_cp(pose_at(above)), CycleStatus::wrong_command) << "the first cause";
  EXPECT_EQ(loop.servo_cp(pose_at(above)), CycleStatus::guarded) << "once only";
}

TEST_F(Crtk, ARefusedSetpointIsNotWhereItEngages) {
  Loop loop;
  loop.report(pose_at(above));
  loop.session.on_setpoint_cp({{test::nan, 0, 0}, tilted}, {loop.now});
  loop.session.release();
  EXPECT_EQ(loop.session.engage(loop.now), CycleStatus::unmeasured);
}

TEST_F(Crtk, ASetpointFromBeforeTheLastOneSentIsNotWhereItEngages) {
  Loop loop = engaged();
  loop.session.on_setpoint_cp(pose_at(above), {loop.now});
  loop.press(top + 1.0, 15);
  loop.session.release();
  EXPECT_EQ(loop.session.engage(loop.now), CycleStatus::unmeasured) << "the robot has moved on";
  EXPECT_EQ(loop.engage(pose_at({3, 4, top + 2.0})), CycleStatus::guarded);
}

TEST_F(Crtk, EngagesAgainAfterTheClockWasSetBack) {
  Loop loop = engaged();
  loop.press(top + 1.0, 15);
  loop.session.release();
  loop.now -= 60.0;
  EXPECT_EQ(loop.engage(pose_at({3, 4, top + 2.0})), CycleStatus::guarded);
}

TEST_F(Crtk, AStateThatIsReportedCountsWithoutFeedbackToo) {
  Loop loop({.needs_feedback = false});
  loop.session.on_setpoint_cp(pose_at(above), {loop.now});
  EXPECT_EQ(loop.session.engage(loop.now), CycleStatus::guarded);
  EXPECT_EQ(loop.session.operating_state(), OperatingState::enabled);
  loop.session.on_operating_state(OperatingState::fault, true);
  EXPECT_EQ(loop.session.operating_state(), OperatingState::fault);
  EXPECT_EQ(loop.servo_cp(pose_at(above)), CycleStatus::not_ready);
}

TEST_F(Crtk, TheGuidesOfTheConstraintStay) {
  MotionConstraint guard = guard_of(cube());
  guard.set_guides({Guide::point("corridor", Region::slab(above, Vec3::UnitX(), 1.0))});
  Loop loop;
  loop.session = {std::move(guard), registration(), {}};
  loop.engage(pose_at(above));
  for (int i = 1; i <= 200; ++i) loop.servo_cp(pose_at(above + 0.02 * i * Vec3::UnitX()));
  const Vec3 sent = registration().point_to_mesh(loop.session.setpoint_cp()->position);
  EXPECT_NEAR(sent.x(), above.x() + 1.0, 0.01);
}

TEST_F(Crtk, AConvexToolIsRefusedForItWouldNotTurn) {
  const auto with_tool = [] {
    CrtkSession(guard_of(cube(), {.options = {.tool_radius = 0.0, .margin = kept},
                                  .tool = ConvexTool::capsule({0, 0, 0}, {0, 0, 9}, 1)}),
                registration(), {});
  };
  EXPECT_NE(error_of(with_tool).find("would not turn"), std::string::npos);
}

TEST_F(Crtk, DefaultsForMillimetersAreRefusedForAMeshInMeters) {
  const auto in_meters = Registration::mesh_from_robot(
      Eigen::Matrix4d::Identity(),
      {.transform = LengthUnit::metre, .robot = LengthUnit::metre, .mesh = LengthUnit::metre});
  EXPECT_NE(error_of([&] { CrtkSession(guard_of(cube()), in_meters, {}); }).find("top_speed [m/s]"),
            std::string::npos);
  CrtkSession(guard_of(cube()), in_meters,
              {.haptic = {.spring = {.stiffness = 1000.0}, .top_speed = 0.2, .farthest = 0.05},
               .farthest_lag = 0.005,
               .farthest_start = 1.0});
}

TEST_F(Crtk, AContestedRobotStandsStill) {
  Loop loop = engaged();
  loop.session.on_contest(true);
  EXPECT_EQ(loop.servo_cp(pose_at(above + Vec3(0.1, 0, 0))), CycleStatus::contested);
  EXPECT_EQ(loop.session.setpoint_cp()->position, pose_at(above).position);
  EXPECT_EQ(loop.engage(pose_at(above)), CycleStatus::contested);
  loop.session.on_contest(false);
  EXPECT_EQ(loop.engage(pose_at(above)), CycleStatus::guarded);
}

TEST_F(Crtk, ATipTakesNoJoints) {
  Loop loop = engaged();
  const std::vector<double> joints(6, 0.0);
  loop.session.on_servo_jp(joints, {loop.now});
  EXPECT_EQ(loop.wait(), CycleStatus::wrong_command);
  loop.session.on_servo_jv(joints, {loop.now});
  EXPECT_EQ(loop.wait(), CycleStatus::wrong_command);
  EXPECT_TRUE(loop.session.setpoint_jp().empty());
}

TEST_F(Crtk, AnotherMeshIsFollowedAfterRelease) {
  Loop loop = engaged();
  const auto higher = mesh_of(moved(make_cube(10.0), Vec3::UnitZ()));
  loop.session.set_mesh(higher, std::make_shared<WideBvh>(higher));
  EXPECT_FALSE(loop.session.engaged());
  EXPECT_EQ(loop.engage(pose_at(above)), CycleStatus::guarded);
  loop.press(top - 1.0);
  const Vec3 held(3, 4, top + 1.0 + kept);
  EXPECT_LT((loop.session.setpoint_cp()->position - pose_at(held).position).norm(), accuracy);
  const Pose before = *loop.session.setpoint_cp();
  EXPECT_THROW(loop.session.set_mesh(cube(), std::make_shared<WideBvh>(higher)), Error);
  EXPECT_EQ(loop.session.setpoint_cp()->position, before.position) << "nothing has changed";
}

TEST_F(Crtk, ARobotIsKeptInTheGuides) {
  const Guide corridor = Guide::point("corridor", Region::slab(above, Vec3::UnitX(), 1.0));
  Loop loop = engaged({.haptic = {.guides = {corridor}}});
  for (int i = 1; i <= 200; ++i) loop.servo_cp(pose_at(above + 0.02 * i * Vec3(1.0, 0.1, 0.0)));
  const Vec3 sent = registration().point_to_mesh(loop.session.setpoint_cp()->position);
  EXPECT_NEAR(corridor.region().excess(sent), 0.0, corridor.band() + 1e-9);
  EXPECT_NEAR(sent.y(), above.y() + 0.4, 1e-5) << "along the corridor it follows";
  EXPECT_TRUE(loop.session.cycle().limits.has(Limit::guide));
}

TEST_F(Crtk, ARobotStandsOnceTheMeshHasMoved) {
  const auto tree = std::make_shared<WideBvh>(cube());
  Loop loop;
  loop.session = {
      make_motion_constraint(cube(), tree, {.options = {.margin = kept}}), registration(), {}};
  loop.engage(pose_at(above));
  EXPECT_EQ(loop.servo_cp(pose_at(above)), CycleStatus::guarded);
  const Vec3 before = loop.session.setpoint_cp()->position;
  tree->refit(mesh_of(moved(make_cube(10.0), Vec3::UnitZ())));
  EXPECT_EQ(loop.servo_cp(pose_at(above + Vec3(0.1, 0, 0))), CycleStatus::stopped);
  EXPECT_EQ(loop.session.cycle().step, Status::mesh_changed);
  EXPECT_EQ(loop.session.setpoint_cp()->position, before);
}

TEST_F(Crtk, AnotherRegistrationIsTakenOnLettingGo) {
  Loop loop = engaged();
  const auto moved = Registration::mesh_from_robot(
      Eigen::Matrix4d::Identity(),
      {.transform = LengthUnit::metre, .robot = LengthUnit::metre, .mesh = LengthUnit::millimetre});
  loop.session.set_registration(moved);
  EXPECT_FALSE(loop.session.setpoint_cp());
  EXPECT_EQ(loop.servo_cp(pose_at(above)), CycleStatus::not_engaged);
  EXPECT_EQ(loop.engage({0.001 * above, tilted}), CycleStatus::guarded);
  EXPECT_EQ(loop.session.cycle().proxy, moved.point_to_mesh(0.001 * above));
}

TEST_F(Crtk, OptionsOutOfRangeAreRefused) {
  for (const double bad : {0.0, -1.0, test::nan}) {
    EXPECT_THROW(Loop({.motion_scale = bad}), Error);
    EXPECT_THROW(Loop({.farthest_lag = bad}), Error);
    EXPECT_THROW(Loop({.farthest_start = bad}), Error);
  }
  EXPECT_THROW(Loop({.longest_silence = test::nan}), Error);
  EXPECT_THROW(Loop({.hand_from_robot = -Mat3::Identity()}), Error);
  EXPECT_THROW(Loop({.hand_from_robot = 1000.0 * Mat3::Identity()}), Error);
  EXPECT_THROW(Loop({.haptic = {.period = 0.0}}), Error);
  EXPECT_EQ(error_of([&] { Loop({.motion_scale = -1.0}); }),
            "CRTK session: motion_scale: expected a number above 0 and at most 1000, got -1");
}

TEST(CycleStatus, EachHasANameAndAReasonOfItsOwn) {
  std::set<std::string_view> names, reasons;
  for (int i = 0; i <= static_cast<int>(CycleStatus::wrong_command); ++i) {
    names.insert(name(static_cast<CycleStatus>(i)));
    reasons.insert(reason(static_cast<CycleStatus>(i)));
  }
  EXPECT_EQ(names.size(), 13u);
  EXPECT_EQ(reasons.size(), 13u);
  EXPECT_FALSE(names.contains("unknown"));
}

TEST(OperatingState, HasTheNamesOfCrtk) {
  for (const auto state : {OperatingState::disabled, OperatingState::enabled,
                           OperatingState::paused, OperatingState::fault}) {
    EXPECT_EQ(operating_state_of(name(state)), state);
  }
  EXPECT_EQ(name(OperatingState::enabled), "ENABLED");
  EXPECT_FALSE(operating_state_of("enabled"));
}

}  // namespace
}  // namespace keepout::test::crtk_session
