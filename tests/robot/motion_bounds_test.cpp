// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/robot/motion_bounds.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <string>

#include "keepout/fixtures/robots.h"
#include "robot/configurations.h"
#include "trials.h"

namespace keepout {
namespace {

constexpr int cells = 64;

/// How near the bounds of so many motions come to what is found along them.
struct Tightness {
  double sum = 0.0;
  double largest = 0.0;
  int count = 0;

  void add(double truth, double bound) {
    const double ratio = truth / bound;
    sum += ratio;
    largest = std::max(largest, ratio);
    ++count;
  }
  void report(const std::string& what) const {
    std::printf("%s: truth / bound is %.3f in the mean, %.6f at most, of %d\n", what.c_str(),
                sum / count, largest, count);
  }
};

/// Where a point that a link carries is at s = 0, 1/64, ..., 1.
std::array<Vec3, cells + 1> way(const Chain& chain, const std::vector<double>& q,
                                const std::vector<double>& increment, const LinkPoint& point) {
  std::array<Vec3, cells + 1> places;
  std::vector<double> at(q.size());
  ChainState state;
  for (int i = 0; i <= cells; ++i) {
    for (std::size_t k = 0; k < q.size(); ++k) at[k] = q[k] + (double(i) / cells) * increment[k];
    chain.forward_kinematics(at, state);
    places[static_cast<std::size_t>(i)] = state.at(point.link, point.position);
  }
  return places;
}

void judge(const Instrument& robot, const std::string& name, std::uint64_t seed) {
  const Chain& chain = robot.chain();
  Random random(seed);
  Tightness path;
  Tightness bend;
  // A place is known to some rounding errors of the chain's length.
  const double rounding = 1e-14 * chain.reach();
  const int motions = test::trials(500'000);
  for (int m = 0; m < motions; ++m) {
    const std::vector<double> q = test::configuration(chain, random);
    std::vector<double> increment;
    for (int k = 1; k <= chain.size(); ++k) {
      const double most = chain.joint(k).kind == JointKind::revolute ? 0.4 : 10.0;
      increment.push_back(random.uniform(-most, most));
      // Few joints in every other motion: there the bounds are tightest.
      if (m % 2 == 0 && random.below(2) == 0) increment.back() = 0.0;
    }
    const Body& body = robot.bodies()[random.below(robot.bodies().size())];
    LinkPoint point = body.points[random.below(body.points.size())];
    point.position += random.uniform(0.0, body.radius) * random.direction();

    ChainState state;
    chain.forward_kinematics(q, state);
    const MotionBounds bounds =
        motion_bounds(state, increment, point.link, state.at(point.link, point.position));
    const auto places = way(chain, q, increment, point);
    double length = 0.0;
    double fastest = 0.0;
    double sharpest = 0.0;
    for (std::size_t i = 1; i <= cells; ++i) {
      const double chord = (places[i] - places[i - 1]).norm();
      length += chord;
      fastest = std::max(fastest, cells * chord);
      if (i == cells) break;
      // The mean of the second derivative over two cells, in tents.
      const Vec3 turn = places[i + 1] - 2.0 * places[i] + places[i - 1];
      sharpest = std::max(sharpest, cells * cells * turn.norm());
    }
    ASSERT_LE(fastest, bounds.path + cells * 2 * rounding) << name << ", motion " << m;
    ASSERT_LE(length, bounds.path + cells * 2 * rounding) << name << ", motion " << m;
    ASSERT_LE(sharpest, bounds.bend + cells * cells * 4 * rounding) << name << ", motion " << m;
    if (bounds.path > 0.1) path.add(length, bounds.path);
    if (bounds.bend > 0.1) bend.add(sharpest, bounds.bend);
  }
  path.report(name + "_path");
  bend.report(name + "_bend");
  EXPECT_GT(path.count, motions / 4);
  EXPECT_GT(bend.count, motions / 4);
  EXPECT_GT(path.largest, 0.9) << "no bound that is far too wide";
  EXPECT_GT(bend.largest, 0.75) << "no bound that is far too wide";
}

TEST(MotionBounds, NoMotionOfThePsmIsLongerOrBendsMore) { judge(psm(), "psm", 11); }
TEST(MotionBounds, NoMotionOfTheSevenJointArmIsLongerOrBendsMore) {
  judge(seven_joint_arm(), "seven_joint_arm", 12);
}

TEST(MotionBounds, OfAPsmAtOneKilohertzAreThoseThatThePageStates) {
  // docs/joint-space-step-algorithm.md: M / 2 at a lever of 200 mm.
  const Instrument robot = psm();
  const Chain& chain = robot.chain();
  ChainState state;
  chain.forward_kinematics(std::vector<double>{0.0, 0.0, 200.0, 0.0, 0.0, 0.0}, state);
  std::vector<double> yaw_and_pitch(6, 0.0);
  std::vector<double> all(6);
  for (std::size_t k = 0; k < 6; ++k) {
    all[k] = 1e-3 * chain.joint(static_cast<int>(k) + 1).limits.velocity;
    if (k < 2) yaw_and_pitch[k] = all[k];
  }
  const Vec3 tip = state.flange().position;
  EXPECT_NEAR(0.5e3 * motion_bounds(state, yaw_and_pitch, 6, tip).bend, 0.4, 0.05);  // [um]
  EXPECT_NEAR(0.5e3 * motion_bounds(state, all, 6, tip).bend, 4.8, 0.1);
}

TEST(MotionBounds, OfOneJointTheyAreExact) {
  const Chain turning({Joint{}});
  const Chain sliding({Joint{.kind = JointKind::prismatic, .axis = Vec3::UnitX()}});
  const double q[] = {0.3};
  const double increment[] = {-0.2};
  ChainState state;
  turning.forward_kinematics(q, state);
  const MotionBounds arc = motion_bounds(state, increment, 1, Vec3(30, 40, 7));
  EXPECT_DOUBLE_EQ(arc.path, 50 * 0.2);
  EXPECT_DOUBLE_EQ(arc.bend, 50 * 0.2 * 0.2);
  EXPECT_EQ(motion_bounds(state, increment, 0, Vec3(30, 40, 7)).path, 0.0) << "the base";
  sliding.forward_kinematics(q, state);
  EXPECT_DOUBLE_EQ(motion_bounds(state, increment, 1, Vec3(30, 40, 7)).path, 0.2);
  EXPECT_EQ(motion_bounds(state, increment, 1, Vec3(30, 40, 7)).bend, 0.0);
}

}  // namespace
}  // namespace keepout
