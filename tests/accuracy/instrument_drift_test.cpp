// SPDX-License-Identifier: BSD-3-Clause
// Presses an instrument against one place for a million cycles: nothing that a cycle loses to
// rounding accumulates. The judge uses independent kinematics and distances.

#include "guards.h"
#include "keepout/judges/robot_judge.h"
#include "trials.h"

namespace keepout {
namespace {

struct DriftScene {
  const char* name;
  bool is_guided = false;
  bool is_moving = false;
};

void PrintTo(const DriftScene& scene, std::ostream* out) { *out << scene.name; }

class InstrumentDrift : public testing::TestWithParam<DriftScene> {};

/// Returns the pose of a mesh that swings about its place by 0.2 mm along an axis, after a number
/// of cycles of 1 ms.
Pose swung(int cycle) { return {Vec3(0, 0.12, 0.16) * std::sin(2e-3 * cycle), Mat3::Identity()}; }

TEST_P(InstrumentDrift, NoBodyOrGuideLosesMoreThanItsToleranceInManyCycles) {
  const auto mesh = mesh_of("gear");
  const Vec3 goal = highest_vertex(*mesh) - Vec3(0, 0, 0.5);  // inside the mesh
  const Instrument robot = psm(port_over(goal, 100.0));
  const Chain& chain = robot.chain();
  InstrumentConstraint guard = guard_of(mesh, robot, {.period = 1e-3});
  oracle::JudgedScene scene{
      oracle::judged_psm(), chain.base(), {{std::make_shared<const oracle::TriangleTree>(mesh)}}};
  const Vec3 jaw(0, 10.2, 0);
  if (GetParam().is_guided) {
    // The goal is on the boundary of the guide's region too.
    guard.set_guides({Guide::point("side", {6, jaw}, Region::half_space(goal, Vec3::UnitX()))});
    scene.guides.push_back({.first = {6, jaw},
                            .region = oracle::JudgedGuide::Region::half_space,
                            .origin = goal,
                            .direction = Vec3::UnitX(),
                            .band = guard.options().band});
  }
  std::vector<double> q{0, 0, 0, 0, 0, 0};
  const auto tip = [&] { return test::state_of(chain, q).at(6, jaw); };
  q[2] = tip().z() - goal.z() - 3.0;
  Random random(4);
  oracle::RobotJudge judge(std::move(scene), chain, q, guard.options(), guard.tolerance());
  const int cycles = test::trials(1'000'000);
  int in_contact = 0;
  int stopped = 0;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    if (GetParam().is_moving) {
      const Pose pose = swung(cycle);
      const Twist velocity{.linear = (swung(cycle + 1).position - pose.position) / 1e-3};
      ASSERT_EQ(guard.place(0, pose, velocity), Status::free);
      judge.place(0, pose, velocity);
    }
    const Vec3 way = goal - tip();
    const Vec3 press = way * std::min(1.0, 0.02 / way.norm());
    const InstrumentStep step = guard.step(
        q, {.linear = press + 0.01 * random.direction(), .angular = 1e-3 * random.direction()});
    in_contact += step.limits.has(Limit::mesh) ? 1 : 0;
    stopped += step.ok() ? 0 : 1;
    q = moved(q, step);
    const oracle::RobotVerdict verdict = judge.judge(q, step);
    ASSERT_FALSE(verdict.is_below) << verdict.beyond << ", " << step.reason() << ' ' << cycle;
    ASSERT_FALSE(verdict.is_guide_left) << verdict.guide_room << " in cycle " << cycle;
    ASSERT_FALSE(verdict.limits_broken) << "in cycle " << cycle;
  }
  EXPECT_TRUE(judge.is_recovered()) << "the bodies still have the clearance of the first cycle";
  EXPECT_GT(in_contact, cycles / 2) << "hardly in contact";
  EXPECT_LE(stopped, cycles / 1000);
}

INSTANTIATE_TEST_SUITE_P(Scenes, InstrumentDrift,
                         testing::Values(DriftScene{"still"}, DriftScene{"guided", true},
                                         DriftScene{"moving", false, true}),
                         by_name);

}  // namespace
}  // namespace keepout
