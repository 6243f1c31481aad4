// SPDX-License-Identifier: BSD-3-Clause
#include "relative_motion.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "keepout/fixtures/robots.h"
#include "robot/configurations.h"
#include "trials.h"

namespace keepout {
namespace {

/// Where the mesh sees a place, by formulas of the test's own.
Vec3 seen_by(const Pose& mesh, const Twist& way, double share, const Vec3& place) {
  Mat3 rotation = mesh.rotation;
  const double turn = way.angular.norm();
  if (turn > 0.0) {
    rotation = Eigen::AngleAxisd(share * turn, way.angular / turn).toRotationMatrix() * rotation;
  }
  return rotation.transpose() * (place - mesh.position - share * way.linear);
}

// Instrument and mesh both move: what the mesh sees is longer and bends more than what the world
// does, and is bounded all the same.
TEST(RelativeMotion, NoPointIsElsewhereNorBendsMoreThanIsSaid) {
  const Instrument robot = psm();
  const Chain& chain = robot.chain();
  Budget budget;
  PointMotion motion(robot, budget);
  RelativeMotion seen(robot, motion);
  Random random(5);
  double tightest = 0.0;
  const int motions = test::trials(20'000);
  for (int m = 0; m < motions; ++m) {
    const std::vector<double> q = test::configuration(chain, random);
    JointVector increment{};
    for (int k = 0; k < chain.size(); ++k) {
      const bool turns = chain.joint(k + 1).kind == JointKind::revolute;
      if (m % 3 != 0) {
        increment[static_cast<std::size_t>(k)] = random.uniform(-1, 1) * (turns ? 0.3 : 10.0);
      }
    }
    const Pose mesh{100.0 * random.direction(),
                    Eigen::AngleAxisd(3.0, random.direction()).toRotationMatrix()};
    const Twist way{.linear = random.uniform(0.0, 10.0) * random.direction(),
                    .angular = random.uniform(0.0, 0.3) * random.direction()};
    motion.begin_cycle(q);
    seen.begin_cycle(mesh, way);
    motion.set_trial(increment, CertifiedMotion::actual);
    seen.update_bounds();
    const double rounding = 1e-14 * (chain.reach() + 1000.0);
    for (std::size_t p = 0; p < robot.points().size(); ++p) {
      double sharpest = 0.0;
      for (int c = 0; c <= PointMotion::last_knot; c += 7) {
        const Vec3 expected = seen_by(mesh, way, c / 64.0, motion.points_at(c)[p]);
        ASSERT_LE((seen.points_in_mesh(c)[p] - expected).norm(), rounding);
      }
      for (int c = 1; c < PointMotion::last_knot; ++c) {
        const Vec3 turn = seen.points_in_mesh(c + 1)[p] - 2.0 * seen.points_in_mesh(c)[p] +
                          seen.points_in_mesh(c - 1)[p];
        sharpest = std::max(sharpest, 64.0 * 64.0 * turn.norm());
      }
      ASSERT_LE(sharpest, seen.bend(p) + 64.0 * 64.0 * 4.0 * rounding);
      if (seen.bend(p) > 0.1) tightest = std::max(tightest, sharpest / seen.bend(p));
    }
    for (std::size_t b = 0; b < robot.bodies().size(); ++b) {
      for (int c = 0; c <= PointMotion::last_knot; ++c) {
        for (const std::uint8_t p : robot.points_of(b)) {
          ASSERT_LE((seen.points_in_mesh(c)[p] - seen.start_in_mesh()[p]).norm(),
                    seen.largest_displacement(b) + rounding);
        }
      }
    }
  }
  EXPECT_GT(tightest, 0.9) << "no bound that is far too wide";
}

TEST(RelativeMotion, OfAMeshAtHomeIsThatOfTheWorldToTheBit) {
  const Instrument robot = psm();
  Budget budget;
  PointMotion motion(robot, budget);
  RelativeMotion seen(robot, motion);
  const std::vector<double> q{0.1, -0.2, 80.0, 0.3, 0.1, -0.4};
  motion.begin_cycle(q);
  seen.begin_cycle({}, {});
  motion.set_trial({0.1, 0.1, 3.0}, CertifiedMotion::actual);
  seen.update_bounds();
  EXPECT_EQ(seen.points_in_mesh(17), motion.points_at(17));
  EXPECT_EQ(seen.bend(2), motion.bounds(2).bend);
}

}  // namespace
}  // namespace keepout
