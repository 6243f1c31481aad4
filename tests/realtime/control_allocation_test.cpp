// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "control/guarded_shapes.h"
#include "keepout/control/crtk_guard.h"
#include "keepout/fixtures/random.h"
#include "realtime/counted_allocations.h"

namespace keepout {
namespace {

/// Fails if a cycle allocates. Returns the number of cycles in which a guide limits the proxy.
int count_guided_cycles(const std::vector<Guide>& guides) {
  const auto registration = Registration::mesh_from_robot(
      Eigen::Matrix4d::Identity(),
      {.transform = LengthUnit::metre, .robot = LengthUnit::metre, .mesh = LengthUnit::millimetre});
  CrtkGuard guard(
      guard_of(cube()), registration,
      {.haptic = {.spring = {.damping = 0.01}, .largest_brake = 0.01, .guides = guides}});
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
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
    seen.push_back(guard.servo_cp({{nan, 0, 0}, Mat3::Identity()}));
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
