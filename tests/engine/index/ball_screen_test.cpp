// SPDX-License-Identifier: BSD-3-Clause
#include "index/tree_parts/ball_screen.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "keepout/fixtures/random.h"

namespace keepout {
namespace {

const Box bounds{Vec3::Constant(-100.0), Vec3::Constant(100.0)};

// Compilers have been seen to take the rounded number for the number itself.
TEST(BallScreen, SplitsTheCentreIntoTwoFloatsThatMeanIt) {
  Random random(9);
  for (int i = 0; i < 1000; ++i) {
    const double size = std::pow(10.0, random.uniform(-6.0, 6.0));
    const Ball ball{size * random.direction(), 1.0};
    const BallScreen screen(ball, bounds, LeafFrame());
    ASSERT_TRUE(screen.fits);
    for (int axis = 0; axis < 3; ++axis) {
      const double x = ball.center[axis];
      EXPECT_LE(std::abs(double{screen.high_part[axis]} - x), 0x1p-24 * std::abs(x));
      EXPECT_LE(std::abs(double{screen.high_part[axis]} + double{screen.low_part[axis]} - x),
                0x1p-48 * std::abs(x) + 1e-44);
      EXPECT_LE(double{screen.below[axis]}, x);
      EXPECT_GE(double{screen.above[axis]}, x);
    }
  }
}

TEST(BallScreen, DrawsItsBoundsOnTheSafeSide) {
  Random random(10);
  for (int i = 0; i < 1000; ++i) {
    const double radius = std::pow(10.0, random.uniform(-12.0, 12.0));
    const BallScreen screen({100.0 * random.direction(), radius}, bounds, LeafFrame());
    EXPECT_LE(double{screen.inside2}, radius * radius);
    EXPECT_GE(double{screen.outside2}, radius * radius);
    EXPECT_LE(double{screen.box_inside2}, radius * radius);
    EXPECT_GE(double{screen.box_reach2}, radius * radius);
  }
}

TEST(BallScreen, IsSureOfNothingInABallWithoutASize) {
  const BallScreen screen({Vec3(1, 2, 3), 0.0}, bounds, LeafFrame());
  EXPECT_TRUE(screen.fits);
  EXPECT_LT(screen.inside2, 0.0f);
  EXPECT_LT(screen.box_inside2, 0.0f);
}

TEST(BallScreen, SaysWhereFloatsDoNotReach) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Ball& ball :
       {Ball{Vec3(1e31, 0, 0), 1.0}, Ball{Vec3::Zero(), 1e19}, Ball{Vec3(0, nan, 0), 1.0},
        Ball{Vec3::Zero(), nan}, Ball{Vec3::Zero(), std::numeric_limits<double>::infinity()}}) {
    EXPECT_FALSE(BallScreen(ball, bounds, LeafFrame()).fits);
  }
}

}  // namespace
}  // namespace keepout
