// SPDX-License-Identifier: BSD-3-Clause
// The set-up of the cutting experiment of Li et al. (2020), section V-B. A manipulator with joint
// limits cuts along a plane, within 1 mm to each side, over a skull that it must not touch. The
// judge uses independent kinematics and distances.

#include <cstdio>

#include "guards.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/judges/robot_judge.h"
#include "keepout/mesh/load_mesh.h"

namespace keepout {
namespace {

constexpr double half_width = 1.0;  // [mm]

TEST(CuttingSetUp, KeepsCorridorSkullAndJointsWhateverTheHandDoes) {
  const auto mesh = load_mesh(fixture_path("skull")).mesh;
  const Vec3 top = highest_vertex(*mesh);
  const Instrument robot = psm(port_over(top, 120.0));
  const Chain& chain = robot.chain();
  std::vector<double> q{0, 0, 0, 0, 0, 0};
  ChainState state = test::state_of(chain, q);
  q[2] = state.flange().position.z() - top.z() - 3.0;  // 3 mm above the bone
  chain.forward_kinematics(q, state);
  const LinkPoint tip{6, chain.flange().position};
  auto guard = guard_of(mesh, robot, {.period = 5e-3});
  const Guide corridor = Guide::point(
      "corridor", tip, Region::slab(state.flange().position, Vec3::UnitX(), half_width));
  guard.set_guides({corridor});

  const oracle::JudgedGuide judged{.first = {6, tip.position},
                                   .region = oracle::JudgedGuide::Region::slab,
                                   .origin = state.flange().position,
                                   .direction = Vec3::UnitX(),
                                   .radius = half_width,
                                   .band = corridor.band()};
  Random random(1);
  oracle::RobotJudge judge({monitor::judged_psm(),
                            chain.base(),
                            {{std::make_shared<const monitor::TriangleTree>(mesh)}},
                            {judged}},
                           chain, q, guard.options(), guard.tolerance());
  const double kept = guard.options().margin - guard.options().band - 3.0 * guard.tolerance();
  double farthest = 0.0;  // out of the corridor
  double nearest = test::infinity;
  int held = 0;
  int blocked = 0;
  double cut = 0.0;
  for (int cycle = 0; cycle < test::trials(20'000); ++cycle) {
    // The operator strokes back and forth along the plane, presses on the bone and drifts sideways.
    const double way = cycle / 400 % 2 == 0 ? 1.0 : -1.0;
    const Twist hand{
        .linear = Vec3(std::sin(cycle / 170.0), way, -0.5) * 0.4 + 0.2 * random.direction(),
        .angular = 0.01 * random.direction()};
    const InstrumentStep step = guard.step(q, hand);
    ASSERT_TRUE(step.ok()) << step.reason() << " in cycle " << cycle;
    const oracle::RobotVerdict verdict = judge.judge(moved(q, step));
    ASSERT_FALSE(verdict.is_below || verdict.is_guide_left || verdict.limits_broken)
        << verdict.beyond << ", " << verdict.guide_room << " in cycle " << cycle;
    farthest = std::max(farthest, corridor.band() - verdict.guide_room * guard.tolerance());
    nearest = std::min(nearest, verdict.least);
    for (std::size_t k = 0; k < q.size(); ++k) {
      const JointLimits& limits = chain.joint(static_cast<int>(k) + 1).limits;
      q[k] += step.increment[k];
      ASSERT_TRUE(q[k] >= limits.lower && q[k] <= limits.upper) << "joint " << k + 1;
    }
    held += step.guides[0].limits ? 1 : 0;
    blocked += step.distance ? 1 : 0;
    cut += step.increment.empty() ? 0.0 : std::abs(step.increment[1]);
  }
  std::printf(
      "at most %.6f mm outside of the corridor; at least %.6f mm from the bone; limited by "
      "the corridor in %d cycles, near the bone in %d\n",
      farthest, nearest, held, blocked);
  EXPECT_LE(farthest, corridor.band() + 1e-8);
  EXPECT_GE(nearest, kept);
  EXPECT_GT(held, test::trials(1000));
  EXPECT_GT(blocked, test::trials(1000));
  EXPECT_GT(cut, test::trials(1.0)) << "the robot hardly moves";
}

}  // namespace
}  // namespace keepout
