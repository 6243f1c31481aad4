// SPDX-License-Identifier: BSD-3-Clause
// Motions that would end too close by a millionth to a thousandth of their length: the sizes by
// which an early acceptance or a search region that is too small goes wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "accuracy/certified_loop.h"
#include "keepout/index/query.h"
#include "trials.h"

namespace keepout::test {
namespace {

/// Fails unless the step comes no closer than the margin or the distance at its start.
void expect_safe(Loop& loop, const Vec3& tip, const Step& step, int& moved) {
  if (!step.ok()) return;
  ASSERT_LE(loop.loss(tip, tip + step.motion, loop.distance(tip)), 3.0)
      << name(step.status) << " from " << tip.transpose() << " by " << step.motion.transpose();
  moved += step.motion.isZero(0.0) ? 0 : 1;
}

Vec3 towards_surface(Loop& loop, const Vec3& tip) {
  NearestTriangle nearest(loop.mesh(), loop.guard().index());
  return nearest(tip).closest.offset.normalized();
}

Vec3 across(const Vec3& in, Random& random) {
  const Vec3 direction = random.direction();
  return direction - direction.dot(in) * in;
}

double log_uniform(Random& random, double low, double high) {
  return std::pow(10.0, random.uniform(std::log10(low), std::log10(high)));
}

TEST(ShallowBreach, OfAMotionThatGlancesIsSeen) {
  Random random(6);
  int moved = 0;
  constexpr const char* names[] = {"gear", "cortex", "sphere", "cube", "needles", "fan"};
  for (int trial = 0; trial < trials(12); ++trial) {
    const double margin = trial % 2 == 0 ? 0.2 : 1.0;
    Loop loop(make_shape(names[trial % 6]), {.radius = 1.0, .margin = margin});
    SCOPED_TRACE(names[trial % 6]);
    const double beyond = random.uniform(0.0, 0.3);
    for (const Vec3& tip : places(loop, 12, margin + beyond, random)) {
      const Vec3 in = towards_surface(loop, tip);
      for (int i = 0; i < 6; ++i) {
        const Vec3 desired = (beyond + log_uniform(random, 1e-9, 1e-4)) * in +
                             random.uniform(0.0, 0.5) * across(in, random);
        ASSERT_NO_FATAL_FAILURE(expect_safe(loop, tip, loop.step(tip, desired), moved));
      }
    }
  }
  EXPECT_GT(moved, trials(400));
}

// The region of a motion has its farthest points straight ahead and straight behind, and the box of
// a face that is square to an axis is no larger than the face. So only the last bit of the region
// has the face in it.
TEST(ShallowBreach, OfAMotionStraightAtAFaceIsSeen) {
  Random random(7);
  int moved = 0;
  for (const double margin : {0.2, 1.0, 4.0}) {
    Loop loop(make_cube(20.0), {.radius = 2.0, .margin = margin});
    const double face = loop.mesh().bounds().high.x();
    for (int i = 0; i < trials(600); ++i) {
      const auto axis = static_cast<Eigen::Index>(random.below(3));
      const double length = random.uniform(0.1, 1.9);
      const double missing = log_uniform(random, 1e-8, 1e-3) * (margin + length);
      Vec3 tip(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5));
      tip *= face;
      tip[axis] = face + margin + length - missing;
      // From afar, and from next to where the last step was, which keeps what is known of there.
      for (int repeat = 0; repeat < 3; ++repeat) {
        const Vec3 desired = -length * Vec3::Unit(axis);
        ASSERT_NO_FATAL_FAILURE(expect_safe(loop, tip, loop.step(tip, desired), moved));
        for (int a = 0; a < 3; ++a) tip[a] += a == axis ? 0.0 : random.uniform(-0.1, 0.1);
      }
    }
  }
  EXPECT_GT(moved, trials(400));
}

// A damped step ends beside the desired one. That nothing is near the one does not prove the other.
TEST(ShallowBreach, BesideADesiredMotionThatIsFreeIsSeen) {
  Random random(5);
  int moved = 0;
  MotionConstraintSettings settings{.radius = 1.0, .margin = 0.2};
  for (const double damping : {1e-5, 1e-4, 5e-4}) {
    settings.damping = damping;
    Loop loop(make_shape("cube"), settings);
    for (const Vec3& tip : places(loop, 30, 0.2001, random)) {
      const Vec3 in = towards_surface(loop, tip);
      for (int i = 0; i < trials(40); ++i) {
        TipJacobian::Matrix columns(3, 3);
        for (int c = 0; c < 3; ++c) columns.col(c) = random.uniform(0.1, 1.5) * random.direction();
        const Vec3 desired =
            random.uniform(0.05, 1.0) * across(in, random) + random.uniform(-3e-4, 1e-4) * in;
        const Step step =
            loop.guard().step({.tip = tip, .desired = desired, .jacobian = TipJacobian(columns)});
        ASSERT_NO_FATAL_FAILURE(expect_safe(loop, tip, step, moved));
      }
    }
  }
  EXPECT_GT(moved, trials(1000));
}

}  // namespace
}  // namespace keepout::test
