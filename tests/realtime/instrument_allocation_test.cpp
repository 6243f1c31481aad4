// SPDX-License-Identifier: BSD-3-Clause
#include <set>

#include "control/guarded_shapes.h"
#include "keepout/control/crtk_guard.h"
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

/// Fails if a cycle allocates. Returns the number of cycles in which a guide limits the proxy.
int count_guided_cycles(const std::vector<Guide>& guides) {
  const auto registration = Registration::mesh_from_robot(
      Eigen::Matrix4d::Identity(),
      {.transform = LengthUnit::metre, .robot = LengthUnit::metre, .mesh = LengthUnit::millimetre});
  CrtkGuard guard(
      guard_of(cube()), registration,
      {.haptic = {.spring = {.damping = 0.01}, .largest_brake = 0.01, .guides = guides}});
  Random random(4);
  std::vector<CycleStatus> seen;
  seen.reserve(100'000);
  int guided = 0;
  const std::size_t before = allocations();
  for (int round = 0; round < 50; ++round) {
    const Pose start{0.001 * (Vec3(3, 4, top + 5.0) + random.direction()), Mat3::Identity()};
    seen.push_back(guard.servo_cp(start));
    seen.push_back(guard.engage({1000.0 * start.position, Mat3::Identity()}));
    seen.push_back(guard.engage(start));
    for (int i = 0; i < 100; ++i) {
      const Vec3 goal = start.position - Vec3(0, 0, 1e-4 * i) + 1e-4 * random.direction();
      guard.measured_cp(*guard.setpoint_cp());
      seen.push_back(guard.servo_cp({goal, Mat3::Identity()}));
      guided += guard.cycle().limits.has(Limit::guide) ? 1 : 0;
    }
    guard.measured_cp({Vec3::Constant(0.5), Mat3::Identity()});
    seen.push_back(guard.servo_cp(start));
    seen.push_back(guard.servo_cp({{test::nan, 0, 0}, Mat3::Identity()}));
    seen.push_back(guard.servo_cp({Vec3::Constant(5.0), Mat3::Identity()}));
    seen.push_back(guard.servo_cp(start));
    for (int i = 0; i < 30; ++i) seen.push_back(guard.await_cp());
    guard.release();
    seen.push_back(guard.engage({Vec3::Zero(), Mat3::Identity()}));
    seen.push_back(guard.servo_cp({Vec3::Zero(), Mat3::Identity()}));
    guard.release();
  }
  EXPECT_EQ(allocations(), before);
  EXPECT_EQ(std::set<CycleStatus>(seen.begin(), seen.end()).size(), 8u) << "every outcome";
  return guided;
}

TEST(CrtkGuard, AllocatesNothingWhateverTheOutcome) { EXPECT_EQ(count_guided_cycles({}), 0); }

TEST(CrtkGuard, AllocatesNothingWithGuides) {
  const Vec3 start(3, 4, top + 5.0);
  const std::vector<Guide> guides{
      Guide::point("corridor", Region::slab(start, Vec3::UnitX(), 0.5)),
      Guide::point("ball", Region::ball(start, 4.0)),
      Guide::point("beyond the cube", Region::half_space(start + Vec3(0, 9, 0), Vec3::UnitY())),
      Guide::point("before the cube", Region::half_space(start - Vec3(0, 9, 0), -Vec3::UnitY()))};
  EXPECT_GT(count_guided_cycles(guides), 1000);
}

}  // namespace
}  // namespace keepout
