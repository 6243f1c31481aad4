// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "keepout/fixtures/random.h"
#include "keepout/geometry/shapes.h"

namespace keepout {
namespace {

TEST(UnitNormal, FollowsTheRightHandRule) {
  const Triangle t{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0, 3, 0)};
  EXPECT_EQ(unit_normal(t), Vec3(0, 0, 1));
  EXPECT_EQ(unit_normal({t[0], t[2], t[1]}), Vec3(0, 0, -1));
}

TEST(UnitNormal, IsTheSameToTheBitHoweverTheTriangleIsRotatedAndOppositeWhenFlipped) {
  Random random(1);
  for (int i = 0; i < 10'000; ++i) {
    const Triangle t{random.direction(), random.direction(), random.direction()};
    const Vec3 normal = unit_normal(t);
    ASSERT_NEAR(normal.norm(), 1.0, 1e-15);
    ASSERT_EQ(unit_normal({t[1], t[2], t[0]}), normal);
    ASSERT_EQ(unit_normal({t[2], t[0], t[1]}), normal);
    ASSERT_EQ(unit_normal({t[1], t[0], t[2]}), -normal);
  }
}

TEST(UnitNormal, IsOfUnitLengthHoweverThinOrSmallTheTriangle) {
  for (int exponent = -300; exponent <= 30; ++exponent) {
    const double small = std::pow(10.0, exponent);
    const Triangle thin{Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(1, small, small)};
    const Triangle tiny{Vec3(0, 0, 0), Vec3(small, 0, 0), Vec3(small, small, small)};
    for (const Triangle& t : {thin, tiny}) {
      ASSERT_LT((unit_normal(t) - Vec3(0, -1, 1).normalized()).norm(), 1e-15) << exponent;
      ASSERT_EQ(unit_normal({t[0], t[2], t[1]}), -unit_normal(t));
    }
  }
}

TEST(UnitNormal, IsZeroWithoutAnArea) {
  EXPECT_EQ(unit_normal({Vec3(1, 2, 3), Vec3(1, 2, 3), Vec3(4, 5, 6)}), Vec3::Zero());
  EXPECT_EQ(unit_normal({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)}), Vec3::Zero());
  EXPECT_EQ(unit_normal({Vec3(0, 0, 0), Vec3(1e-200, 0, 0), Vec3(3e-200, 0, 0)}), Vec3::Zero());
}

}  // namespace
}  // namespace keepout
