// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <vector>

#include "guards.h"
#include "keepout/control/crtk_session.h"
#include "keepout/error.h"
#include "keepout/oracle/instrument_oracle.h"
#include "messages.h"
#include "trials.h"

namespace keepout::test::instrument_session {
namespace {

constexpr double period = 0.001;

/// Returns a registration that rotates the mesh in the robot's frame, and moves it by 20 mm.
Registration registration() {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() =
      Eigen::AngleAxisd(0.4, Vec3(1, -2, 3).normalized()).toRotationMatrix();
  matrix.topRightCorner<3, 1>() = Vec3(12, -16, 0);
  return Registration::robot_from_mesh(matrix, {.transform = LengthUnit::millimetre,
                                                .robot = LengthUnit::metre,
                                                .mesh = LengthUnit::millimetre});
}

std::shared_ptr<const Mesh> cube() {
  static const auto mesh = mesh_of(make_cube(20.0));
  return mesh;
}

/// A psm above a cube, whose port is 120 mm above the origin of the robot's frame.
class Loop {
 public:
  explicit Loop(CrtkOptions options = {})
      : instrument(psm(port_over(Vec3::Zero(), 120.0))),
        session(guard(), registration(), with_period(std::move(options))) {}

  InstrumentConstraint guard() const { return guard_of(cube(), instrument, {.period = period}); }
  static CrtkOptions with_period(CrtkOptions options) {
    options.haptic.period = period;
    return options;
  }

  /// Returns positions in the unit of the robot, m: joint 3 is the insertion.
  static std::vector<double> in_meters(std::vector<double> q) {
    q[2] /= 1000.0;
    return q;
  }
  CycleStatus engage(const std::vector<double>& q) {
    session.on_operating_state(OperatingState::enabled, true);
    session.on_measured_js(in_meters(q), {now});
    session.on_setpoint_js(in_meters(q), {now});
    return session.engage(now);
  }
  CycleStatus tick() {
    now += period;
    const auto sent = session.setpoint_jp();
    if (!sent.empty()) session.on_measured_js(sent, {now});
    return session.tick(now);
  }
  CycleStatus servo_cp(const Pose& goal) {
    session.on_servo_cp(goal, {now + period});
    return tick();
  }
  CycleStatus servo_jp(const std::vector<double>& goal) {
    session.on_servo_jp(goal, {now + period});
    return tick();
  }
  CycleStatus servo_jv(const std::vector<double>& velocity) {
    session.on_servo_jv(velocity, {now + period});
    return tick();
  }

  Instrument instrument;
  CrtkSession session;
  double now = 5.0;  // [s]
};

const std::vector<double> start{0, 0, 30, 0.2, 0.1, 0};  // [mm] in joint 3

/// Measures the clearance of a session's setpoint by an oracle that knows the registration alone.
class Judge {
 public:
  explicit Judge(const Instrument& instrument)
      : oracle_(std::make_shared<monitor::TriangleTree>(cube()), monitor::judged_psm(),
                in_mesh(instrument.chain().base())) {}
  double clearance(std::span<const double> setpoint_jp) {
    std::vector<double> q(setpoint_jp.begin(), setpoint_jp.end());
    q[2] *= 1000.0;
    oracle_.move_to(q);
    return oracle_.clearance(1e3);
  }

 private:
  static Pose in_mesh(const Pose& base) {
    const Vec3 x = registration().point_to_mesh(0.001 * (base * Vec3::UnitX()));
    const Vec3 y = registration().point_to_mesh(0.001 * (base * Vec3::UnitY()));
    const Vec3 z = registration().point_to_mesh(0.001 * (base * Vec3::UnitZ()));
    Pose pose;
    pose.position = registration().point_to_mesh(0.001 * base.position);
    pose.rotation << x - pose.position, y - pose.position, z - pose.position;
    return pose;
  }
  oracle::InstrumentOracle oracle_;
};

TEST(InstrumentSession, StartsWhereTheRobotIs) {
  Loop loop;
  ASSERT_EQ(loop.engage(start), CycleStatus::guarded);
  const Pose flange = test::state_of(loop.instrument.chain(), start).flange();
  EXPECT_LT((loop.session.setpoint_cp()->position - 0.001 * flange.position).norm(), 1e-15);
  EXPECT_EQ(loop.session.setpoint_cp()->rotation, flange.rotation);
  for (std::size_t k = 0; k < start.size(); ++k) {
    EXPECT_DOUBLE_EQ(loop.session.setpoint_jp()[k], Loop::in_meters(start)[k]);
  }
  EXPECT_EQ(loop.session.servo_cf().force, Vec3::Zero());
  EXPECT_EQ(loop.tick(), CycleStatus::guarded) << "the goal is where it is";
  EXPECT_NEAR(loop.session.setpoint_jp()[2], 0.030, 1e-12);
}

TEST(InstrumentSession, SendsWhatADirectConstraintSendsToTheLastBit) {
  Loop loop;
  ASSERT_EQ(loop.engage(start), CycleStatus::guarded);
  InstrumentConstraint direct = loop.guard();
  direct.place(0, registration().mesh_in_robot());
  std::vector<double> q = Loop::in_meters(start);
  q[2] *= 1000.0;
  Judge judge(loop.instrument);
  Random random(4);
  int limited = 0;
  for (int i = 0; i < 400; ++i) {
    std::vector<double> velocity(6);
    for (double& number : velocity) number = random.uniform(-0.3, 0.3);
    velocity[2] = random.uniform(-0.05, 0.25);  // [m/s], on the whole into the cube
    std::vector<double> increment = velocity;
    increment[2] *= 1000.0;
    for (double& number : increment) number *= period;
    const InstrumentStep step = direct.step(q, increment);
    ASSERT_TRUE(step.ok());
    q = moved(q, step);
    ASSERT_EQ(loop.servo_jv(velocity), CycleStatus::guarded);
    EXPECT_EQ(loop.session.cycle().step, step.status);
    limited += step.status == Status::limited ? 1 : 0;
    for (std::size_t k = 0; k < q.size(); ++k) {
      ASSERT_EQ(loop.session.setpoint_jp()[k], k == 2 ? q[k] / 1000.0 : q[k]) << i;
    }
    ASSERT_GE(judge.clearance(loop.session.setpoint_jp()), 0.198 - 1e-8);
  }
  EXPECT_GT(limited, 20);
}

TEST(InstrumentSession, HoldsEveryBodyOffForEachCommandAndTheHandFeelsIt) {
  for (const bool by_pose : {true, false}) {
    Loop loop({.haptic = {.spring = {.largest_force = 2.5}}, .farthest_lag = 1.0});
    Judge judge(loop.instrument);
    ASSERT_EQ(loop.engage(start), CycleStatus::guarded);
    const Pose from = *loop.session.setpoint_cp();
    int limited = 0;
    for (int i = 1; i <= 1500; ++i) {
      const double depth = 0.05 * std::min(i, 1100);  // [mm]
      if (by_pose) {
        Pose goal = from;
        goal.position.z() -= 0.001 * depth;
        ASSERT_EQ(loop.servo_cp(goal), CycleStatus::guarded) << loop.session.reason();
      } else {
        std::vector<double> goal = start;
        goal[2] += depth;
        ASSERT_EQ(loop.servo_jp(Loop::in_meters(goal)), CycleStatus::guarded);
      }
      limited += loop.session.cycle().limits.has(Limit::mesh) ? 1 : 0;
      ASSERT_GE(judge.clearance(loop.session.setpoint_jp()), 0.198 - 1e-8) << i;
    }
    EXPECT_GT(limited, 100);
    EXPECT_LT(judge.clearance(loop.session.setpoint_jp()), 0.5) << "it arrives at the surface";
    // The spring pulls the hand from the goal to the tool: up.
    EXPECT_GT(loop.session.servo_cf().force.z(), 0.5);
    EXPECT_LE(loop.session.servo_cf().force.norm(), 2.5 + 1e-12);
    loop.session.release();
    EXPECT_EQ(loop.session.servo_cf().force, Vec3::Zero());
    EXPECT_TRUE(loop.session.setpoint_jp().empty());
  }
}

TEST(InstrumentSession, MovesNoFasterThanTheTopSpeed) {
  Loop loop({.haptic = {.top_speed = 10.0}});
  ASSERT_EQ(loop.engage(start), CycleStatus::guarded);
  Pose goal = *loop.session.setpoint_cp();
  goal.position.z() += 0.010;
  Vec3 before = loop.session.setpoint_cp()->position;
  for (int i = 0; i < 50; ++i) {
    ASSERT_EQ(loop.servo_cp(goal), CycleStatus::guarded);
    const double way = 1000.0 * (loop.session.setpoint_cp()->position - before).norm();
    ASSERT_LE(way, 0.01 * (1.0 + 1e-4)) << "the motion of the flange is curved";
    before = loop.session.setpoint_cp()->position;
  }
  goal = *loop.session.setpoint_cp();
  goal.rotation = Eigen::AngleAxisd(2.0, Vec3::UnitX()).toRotationMatrix() * goal.rotation;
  const Mat3 from = loop.session.setpoint_cp()->rotation;
  for (int i = 0; i < 50; ++i) ASSERT_EQ(loop.servo_cp(goal), CycleStatus::guarded);
  const Eigen::AngleAxisd turn(Mat3(loop.session.setpoint_cp()->rotation * from.transpose()));
  EXPECT_GT(turn.angle(), 1e-3);
  EXPECT_LE(turn.angle(), 50 * 0.01 / loop.guard().options().orientation_weight * 1.01);
}

TEST(InstrumentSession, TurnsTheFlangeTowardsTheGoal) {
  Loop loop;
  ASSERT_EQ(loop.engage(start), CycleStatus::guarded);
  Pose goal = *loop.session.setpoint_cp();
  goal.rotation = Eigen::AngleAxisd(0.3, Vec3::UnitZ()).toRotationMatrix() * goal.rotation;
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(loop.servo_cp(goal), CycleStatus::guarded);
  EXPECT_LT((loop.session.setpoint_cp()->rotation - goal.rotation).norm(), 1e-3);
  EXPECT_LT((loop.session.setpoint_cp()->position - goal.position).norm(), 1e-5);
}

TEST(InstrumentSession, StandsStillForWhatIsWrong) {
  const auto setpoint_of = [](const Loop& loop) {
    const auto sent = loop.session.setpoint_jp();
    return std::vector<double>(sent.begin(), sent.end());
  };
  Loop loop({.farthest_lag = 2.0});
  EXPECT_EQ(loop.servo_jp(start), CycleStatus::not_ready);
  ASSERT_EQ(loop.engage(start), CycleStatus::guarded);
  const std::vector<double> before = setpoint_of(loop);
  std::vector<double> goal = before;
  goal[2] += 0.001;
  EXPECT_EQ(loop.servo_jp({0, 0, 0.03}), CycleStatus::wrong_command) << "three joints";
  EXPECT_EQ(loop.servo_jv({0, 0, 0, 0, 0, 0, 0}), CycleStatus::wrong_command);
  EXPECT_EQ(loop.servo_jp({0, 0, test::nan, 0, 0, 0}), CycleStatus::invalid_pose);
  EXPECT_EQ(loop.servo_jp(start), CycleStatus::too_far) << "millimeters";
  EXPECT_EQ(loop.servo_cp({Vec3(5, 0, 0), Mat3::Identity()}), CycleStatus::too_far);
  EXPECT_EQ(loop.servo_cp({Vec3::Zero(), 2.0 * Mat3::Identity()}), CycleStatus::invalid_pose);
  std::vector<double> elsewhere = before;
  elsewhere[2] += 0.0021;
  loop.now += period;
  loop.session.on_measured_js(elsewhere, {loop.now});
  loop.session.on_servo_jp(goal, {loop.now});
  EXPECT_EQ(loop.session.tick(loop.now), CycleStatus::lagging);
  for (int i = 0; i < 20; ++i) loop.tick();
  EXPECT_EQ(loop.tick(), CycleStatus::stale);
  EXPECT_EQ(loop.session.tick(loop.now + 1.0), CycleStatus::stale);
  loop.session.on_servo_jp(goal, {loop.now + 1.0});
  EXPECT_EQ(loop.session.tick(loop.now + 1.0), CycleStatus::unmeasured);
  loop.session.on_contest(true);
  EXPECT_EQ(loop.servo_jp(goal), CycleStatus::contested);
  EXPECT_EQ(loop.engage({0, 0, test::nan, 0, 0, 0}), CycleStatus::contested);
}

TEST(InstrumentSession, WaitsForABodyThatLagsThoughTheFlangeDoesNot) {
  // The flange is on the axis of the only joint; the body is 30 mm beside it.
  const Instrument lever(
      Chain({Joint{.limits = {.velocity = 1.0}}}, {Vec3(0, 0, 150), Mat3::Identity()}),
      {{.points = {{1, Vec3(30, 0, 0)}}, .radius = 1.0}});
  CrtkSession session(guard_of(cube(), lever, {.period = period}), registration(),
                      {.farthest_lag = 2.0});
  session.on_operating_state(OperatingState::enabled, true);
  session.on_setpoint_js(std::vector<double>{0.0}, {0.0});
  ASSERT_EQ(session.engage(0.0), CycleStatus::guarded);
  for (const auto& [angle, expected] :
       {std::pair{0.06, CycleStatus::guarded}, {0.07, CycleStatus::lagging}}) {
    session.on_measured_js(std::vector<double>{angle}, {0.001});
    EXPECT_EQ(session.tick(0.001), expected) << angle;
  }
}

TEST(InstrumentSession, WithoutAMeshHasOnlyTheLimitsOfItsJoints) {
  Loop loop;
  CrtkSession session(
      InstrumentConstraint(loop.instrument, std::make_unique<ActiveSet>(), {.period = period}),
      registration(), {.needs_feedback = false});
  session.on_setpoint_js(Loop::in_meters(start), {0.0});
  ASSERT_EQ(session.engage(0.0), CycleStatus::guarded);
  EXPECT_EQ(session.tick(0.001), CycleStatus::guarded);
}

TEST(InstrumentSession, ForgetsMessagesInTheUnitOfAnotherRegistration) {
  Loop loop;
  loop.session.on_operating_state(OperatingState::enabled, true);
  loop.session.on_setpoint_js(Loop::in_meters(start), {loop.now});
  loop.session.set_registration(Registration::mesh_from_robot(Eigen::Matrix4d::Identity(),
                                                              {.transform = LengthUnit::millimetre,
                                                               .robot = LengthUnit::millimetre,
                                                               .mesh = LengthUnit::millimetre}));
  EXPECT_EQ(loop.session.engage(loop.now), CycleStatus::unmeasured);
  loop.session.on_setpoint_js(start, {loop.now});
  EXPECT_EQ(loop.session.engage(loop.now), CycleStatus::guarded);
  EXPECT_EQ(loop.session.setpoint_jp()[2], 30.0);
}

TEST(InstrumentSession, RecoversNoFasterThanTheTopSpeed) {
  Loop loop({.haptic = {.top_speed = 5.0}});
  Judge judge(loop.instrument);
  std::vector<double> close = start;
  double low = 10.0, high = 200.0;  // of the insertion, for a clearance of 0.1 mm
  for (int i = 0; i < 60; ++i) {
    close[2] = 0.5 * (low + high);
    (judge.clearance(Loop::in_meters(close)) > 0.1 ? low : high) = close[2];
  }
  ASSERT_EQ(loop.engage(close), CycleStatus::guarded);
  Vec3 before = loop.session.setpoint_cp()->position;
  int recovering = 0;
  for (int i = 0; i < 40; ++i) {
    const Pose goal{before - Vec3(0, 0, 0.001), loop.session.setpoint_cp()->rotation};
    ASSERT_EQ(loop.servo_cp(goal), CycleStatus::guarded);
    recovering += loop.session.cycle().step == Status::recovering ? 1 : 0;
    EXPECT_LE(1000.0 * (loop.session.setpoint_cp()->position - before).norm(), 0.005 * 1.1);
    before = loop.session.setpoint_cp()->position;
  }
  EXPECT_GT(recovering, 5);
}

TEST(InstrumentSession, StandsStillUntilAfterEachRefusal) {
  Loop loop;
  ASSERT_EQ(loop.engage(start), CycleStatus::guarded);
  std::vector<double> goal = Loop::in_meters(start);
  goal[2] -= 0.005;
  const double before = loop.session.setpoint_jp()[2];
  loop.session.on_servo_jp({}, {loop.now});
  EXPECT_EQ(loop.servo_jp(goal), CycleStatus::wrong_command);
  EXPECT_EQ(loop.session.setpoint_jp()[2], before);
  EXPECT_EQ(loop.servo_jp(goal), CycleStatus::guarded);
  EXPECT_LT(loop.session.setpoint_jp()[2], before);
}

TEST(InstrumentSession, SaysWhatIsWrongWithItsParts) {
  Loop loop;
  EXPECT_EQ(
      error_of([&] { CrtkSession(loop.guard(), registration(), {.haptic = {.period = 0.002}}); }),
      "instrument proxy: period: expected that of the instrument's options");
  const Guide guide = Guide::point("ball", Region::ball(Vec3::Zero(), 1.0));
  EXPECT_EQ(
      error_of([&] { CrtkSession(loop.guard(), registration(), {.haptic = {.guides = {guide}}}); }),
      "instrument proxy: guides: expected none; give them to "
      "InstrumentConstraint::set_guides");
  const Instrument free(Chain({Joint{.name = "turn"}}),
                        {{.points = {{1, Vec3(0, 0, 200)}}, .radius = 1.0}});
  EXPECT_EQ(error_of([&] {
              CrtkSession(guard_of(cube(), free, {.period = period}), registration(), {});
            }),
            "instrument proxy: joint 'turn' (1) has no limit of its velocity or increment: a goal "
            "that jumps would move it at once");
}

}  // namespace
}  // namespace keepout::test::instrument_session
