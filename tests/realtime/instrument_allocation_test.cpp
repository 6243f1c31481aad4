// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <set>

#include "control/guarded_shapes.h"
#include "guards.h"
#include "keepout/control/crtk_session.h"
#include "keepout/fixtures/robots.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/robot/instrument_constraint.h"
#include "keepout/solvers/active_set.h"
#include "realtime/counted_allocations.h"
#include "trials.h"

namespace keepout {
namespace {

TEST(InstrumentConstraint, AllocatesNothingWhateverTheOutcome) {
  const auto mesh = mesh_of("gear");
  const auto index = std::make_shared<WideBvh>(mesh);
  const std::vector<double> start{0, 0, 60, 0, 0, 0};
  std::vector<InstrumentConstraint> guards;
  for (const Vec3& port : {Vec3(0, 0, 100), Vec3(100, 30, 0), Vec3(-60, 90, 20), Vec3(0, 0, 5)}) {
    guards.emplace_back(mesh, index, psm({port, Mat3::Identity()}), std::make_unique<ActiveSet>(),
                        InstrumentOptions{.period = 0.05});
  }
  // All of the mesh is near; then a work budget ends within a cycle; then a ball is inside.
  const auto cube = mesh_of(make_cube(20.0));
  const auto cube_index = std::make_shared<WideBvh>(cube);
  for (const std::size_t work_units : {std::size_t{0}, std::size_t{60}}) {
    guards.emplace_back(cube, cube_index, psm({Vec3(0, 0, 100), Mat3::Identity()}),
                        std::make_unique<ActiveSet>(), InstrumentOptions{.period = 0.05},
                        InstrumentCapacity{.work_units = work_units});
  }
  const Chain turning({Joint{}, Joint{}, Joint{}, Joint{}, Joint{}, Joint{}});
  guards.emplace_back(cube, cube_index,
                      Instrument(turning, {{.points = {{6, Vec3::Zero()}}, .radius = 1.0}}),
                      std::make_unique<ActiveSet>(), InstrumentOptions{});
  guards.emplace_back(psm(), std::make_unique<ActiveSet>(), InstrumentOptions{});  // no mesh
  // Two meshes. One of them approaches, at times faster than the bodies can retreat.
  InstrumentConstraint& beside_two = guards.front();
  beside_two.add_mesh(cube, cube_index, 0.5);
  // Guides of a point, an axis and a shaft. The two half-spaces have no point in common.
  const LinkPoint tip{6, Vec3(0, 10.2, 0)};
  guards[1].set_guides(
      {Guide::point("beyond", tip, Region::half_space(Vec3(300, 0, 0), Vec3::UnitX())),
       Guide::point("before", tip, Region::half_space(Vec3(-100, 0, 0), -Vec3::UnitX())),
       Guide::axis("axis", 6, Vec3::UnitX(), Vec3::UnitZ(), 0.5),
       Guide::remote_center("port", {0, Vec3::Zero()}, {4, Vec3::Zero()}, Vec3(100, 30, -40),
                            1.0)});
  std::vector<Status> seen;
  seen.reserve(100'000);
  int guided = 0;
  int relaxed = 0;
  std::vector<double> q(6);
  const std::vector<double> bad(5);
  Random random(2);
  const std::size_t before = allocations();
  for (InstrumentConstraint& guard : guards) {
    for (int round = 0; round < 20; ++round) {
      q = start;
      for (double& number : q) number += random.uniform(-0.6, 0.6);
      q[2] = random.uniform(0.0, 200.0);
      const double speed = round % 2 == 0 ? 50.0 : 2.0;
      beside_two.place(1, {Vec3(60, 0, 0), Mat3::Identity()}, {.linear = Vec3(-speed, 0, 0)});
      for (int i = 0; i < 50; ++i) {
        const InstrumentStep step = guard.step(
            q, Twist{.linear = 2.0 * random.direction(), .angular = 0.1 * random.direction()});
        seen.push_back(step.status);
        guided += step.limits.has(Limit::guide) ? 1 : 0;
        relaxed += step.relaxation == Relaxation::guides ? 1 : 0;
        for (std::size_t k = 0; k < step.increment.size(); ++k) q[k] += step.increment[k];
      }
      seen.push_back(guard.step(q, q).status);
      seen.push_back(guard.prove(q, start).status);
      seen.push_back(guard.step(bad, Twist{}).status);
      guard.forget();
    }
  }
  EXPECT_EQ(allocations(), before);
  EXPECT_GT(guided, 100);
  EXPECT_GT(relaxed, 100);
  const std::set<Status> kinds(seen.begin(), seen.end());
  for (const Status status : {Status::free, Status::limited, Status::recovering, Status::touching,
                              Status::invalid_input, Status::out_of_budget, Status::inside}) {
    EXPECT_TRUE(kinds.contains(status)) << name(status);
  }
}

/// Returns the registration of a robot in meters, with the axes of the mesh.
Registration registration() {
  return Registration::mesh_from_robot(
      Eigen::Matrix4d::Identity(),
      {.transform = LengthUnit::metre, .robot = LengthUnit::metre, .mesh = LengthUnit::millimetre});
}

/// Sends good and bad messages of every kind to a session near `start`, and ticks. Fails if a
/// cycle allocates. Returns the number of cycles in which a guide limits the proxy. `joints`: the
/// positions at the start; empty for a tip.
int count_guided_cycles(CrtkSession& session, const Pose& start,
                        const std::vector<double>& joints) {
  Random random(4);
  std::vector<CycleStatus> seen;
  seen.reserve(100'000);
  int guided = 0;
  double now = 1.0;
  const std::array<double, 2> wrong_joints{};
  const std::array<double, 6> inside{0, 0, 0.15, 0, 0, 0};  // the cube
  const auto tick = [&] {
    now += 0.001;
    seen.push_back(session.tick(now));
    guided += session.cycle().limits.has(Limit::guide) ? 1 : 0;
  };
  const auto measure = [&](const Vec3& away) {
    session.on_measured_cp({start.position + away, start.rotation}, {now + 0.001, "base"});
    session.on_measured_js(joints, {now + 0.001});
  };
  const auto engage = [&](const Pose& pose) {
    session.on_setpoint_cp(pose, {now, "base"});
    session.on_setpoint_js(joints, {now});
    seen.push_back(session.engage(now));
  };
  const std::size_t before = allocations();
  for (int round = 0; round < 50; ++round) {
    session.on_operating_state(OperatingState::disabled, false);
    tick();
    session.on_operating_state(OperatingState::enabled, true);
    session.on_servo_cp(start, {now});
    tick();
    engage({1000.0 * Vec3::Ones(), start.rotation});
    engage(start);
    const Vec3 side = 0.001 * random.direction();
    for (int i = 0; i < 100; ++i) {
      const Vec3 away = side - Vec3(0, 0, 1e-4 * i) + 1e-4 * random.direction();
      measure(Vec3::Zero());
      session.on_servo_cp({start.position + away, start.rotation}, {now + 0.001, "base"});
      tick();
    }
    if (!joints.empty()) {
      session.on_servo_jp(joints, {now + 0.001});
      tick();
      session.on_servo_jv(joints, {now + 0.001});
      tick();
    }
    session.on_servo_jp(wrong_joints, {now + 0.001});
    tick();
    session.on_servo_cp(start, {now + 0.001, "camera"});
    tick();
    session.on_servo_cp({{test::nan, 0, 0}, start.rotation}, {now + 0.001});
    tick();
    session.on_servo_cp({Vec3::Constant(5.0), start.rotation}, {now + 0.001});
    measure(Vec3::Zero());
    tick();
    session.on_contest(true);
    tick();
    session.on_contest(false);
    measure(Vec3::Constant(0.5));
    if (!joints.empty()) session.on_measured_js(inside, {now + 0.001});
    session.on_servo_cp(start, {now + 0.001});
    tick();
    for (int i = 0; i < 30; ++i) tick();
    session.on_servo_cp(start, {now + 0.001});
    tick();
    session.release();
    session.on_setpoint_cp({Vec3::Zero(), Mat3::Identity()}, {now});
    session.on_setpoint_js(inside, {now});
    session.engage(now);
    measure(-start.position);
    if (!joints.empty()) session.on_measured_js(inside, {now + 0.001});
    session.on_servo_cp({Vec3::Zero(), start.rotation}, {now + 0.001});
    tick();
    session.release();
  }
  EXPECT_EQ(allocations(), before);
  std::set<CycleStatus> kinds(seen.begin(), seen.end());
  for (int i = 0; i <= static_cast<int>(CycleStatus::wrong_command); ++i) {
    const auto status = static_cast<CycleStatus>(i);
    // No configuration of the instrument is far from the mesh.
    if (!joints.empty() && status == CycleStatus::far_from_mesh) continue;
    EXPECT_TRUE(kinds.contains(status)) << name(status);
  }
  return guided;
}

int count_guided_cycles_of_tip(const std::vector<Guide>& guides) {
  CrtkSession session(
      guard_of(cube()), registration(),
      {.haptic = {.spring = {.damping = 0.01}, .largest_brake = 0.01, .guides = guides},
       .frame = "base"});
  return count_guided_cycles(session, {0.001 * Vec3(3, 4, top + 5.0), Mat3::Identity()}, {});
}

TEST(CrtkSession, AllocatesNothingWhateverTheOutcome) {
  EXPECT_EQ(count_guided_cycles_of_tip({}), 0);
}

TEST(CrtkSession, OfAnInstrumentAllocatesNothingWhateverTheOutcome) {
  const auto mesh = mesh_of(make_cube(20.0));
  const Instrument instrument = psm(port_over(Vec3::Zero(), 120.0));
  CrtkSession session(guard_of(mesh, instrument, {.period = 0.001}), registration(),
                      {.haptic = {.spring = {.damping = 0.01}, .largest_brake = 0.01},
                       .farthest_lag = 50.0,
                       .frame = "base"});
  const std::vector<double> start{0, 0, 0.05, 0, 0, 0};  // [m] in joint 3
  const Pose flange =
      test::state_of(instrument.chain(), std::vector<double>{0, 0, 50, 0, 0, 0}).flange();
  EXPECT_EQ(count_guided_cycles(session, {0.001 * flange.position, flange.rotation}, start), 0);
}

TEST(CrtkSession, AllocatesNothingWithGuides) {
  const Vec3 start(3, 4, top + 5.0);
  const std::vector<Guide> guides{
      Guide::point("corridor", Region::slab(start, Vec3::UnitX(), 0.5)),
      Guide::point("ball", Region::ball(start, 4.0)),
      Guide::point("beyond the cube", Region::half_space(start + Vec3(0, 9, 0), Vec3::UnitY())),
      Guide::point("before the cube", Region::half_space(start - Vec3(0, 9, 0), -Vec3::UnitY()))};
  EXPECT_GT(count_guided_cycles_of_tip(guides), 1000);
}

}  // namespace
}  // namespace keepout
