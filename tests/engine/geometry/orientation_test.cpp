// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/orientation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "keepout/fixtures/random.h"
#include "keepout/geometry/shapes.h"

namespace keepout {
namespace {

__extension__ using Wide = __int128;

constexpr int sign_of(Wide value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

Wide whole(double value) { return static_cast<Wide>(value); }

// The oracles are exact for integer coordinates up to 2^40.

Wide exact_turn(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  const int x = (axis + 1) % 3;
  const int y = (axis + 2) % 3;
  return (whole(b[x]) - whole(a[x])) * (whole(c[y]) - whole(a[y])) -
         (whole(b[y]) - whole(a[y])) * (whole(c[x]) - whole(a[x]));
}

Wide exact_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  Wide sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    sum += exact_turn(a, b, c, axis) * (whole(d[axis]) - whole(a[axis]));
  }
  return sum;
}

TEST(SideOfPlane, IsPositiveOnTheSideOfTheNormal) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_EQ(side_of_plane(a, b, c, {0.2, 0.2, 1e-300}), 1);
  EXPECT_EQ(side_of_plane(a, b, c, {5, -7, -1e-300}), -1);
  EXPECT_EQ(side_of_plane(a, b, c, {5, -7, 0}), 0);
}

TEST(Turn, IsPositiveCounterClockwiseAlongEachAxis) {
  EXPECT_EQ(turn({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2), 1);
  EXPECT_EQ(turn({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, 0), 1);
  EXPECT_EQ(turn({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 1), 1);
  EXPECT_EQ(turn({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, 2), -1);
  EXPECT_EQ(turn({0, 0, 0}, {1, 1, 5}, {2, 2, -3}, 2), 0);
}

TEST(Orientation, AgreesWithWholeNumbersWhereDoublesRound) {
  // Points near a line or a plane: determinants in double are only rounding errors.
  std::mt19937_64 random(1);
  std::uniform_int_distribution<int> coarse(-1000, 1000);
  std::uniform_int_distribution<int> fine(-1, 1);
  const auto point = [&](auto& numbers) {
    return Vec3(numbers(random), numbers(random), numbers(random));
  };
  int zeros = 0, wrong_in_doubles = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double scale = std::ldexp(1.0, static_cast<int>(random() % 24));
    const Vec3 a = scale * point(coarse);
    const Vec3 u = scale * point(coarse) + point(fine);
    const Vec3 v = scale * point(coarse) + point(fine);
    const Vec3 b = a + u;
    const Vec3 c = a + v;
    const Vec3 d = a + coarse(random) / 100 * u - coarse(random) / 100 * v + point(fine);
    const int expected = sign_of(exact_side(a, b, c, d));
    ASSERT_EQ(side_of_plane(a, b, c, d), expected) << i;
    ASSERT_EQ(side_of_plane(b, c, a, d), expected) << i;
    ASSERT_EQ(side_of_plane(b, a, c, d), -expected) << i;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 on = a + 2 * u + (random() % 2 == 0 ? point(fine) : Vec3::Zero());
      const int expected_turn = sign_of(exact_turn(a, b, on, axis));
      ASSERT_EQ(turn(a, b, on, axis), expected_turn) << i;
      ASSERT_EQ(turn(b, a, on, axis), -expected_turn) << i;
    }
    zeros += expected == 0 ? 1 : 0;
    const Vec3 normal((b - d).y() * (c - d).z() - (b - d).z() * (c - d).y(),
                      (b - d).z() * (c - d).x() - (b - d).x() * (c - d).z(),
                      (b - d).x() * (c - d).y() - (b - d).y() * (c - d).x());
    const double rounded = -(a - d).dot(normal);
    wrong_in_doubles += (rounded > 0.0 ? 1 : rounded < 0.0 ? -1 : 0) != expected ? 1 : 0;
  }
  EXPECT_GT(zeros, 100);  // else the exact sums were not tested
  EXPECT_GT(wrong_in_doubles, 100);
}

TEST(Orientation, CoordinatesOfVeryDifferentSizeAreSummedExactly) {
  // In double, 1e30 absorbs the digits that decide.
  const Vec3 a(1e30, 1, 0), b(1e30, 2, 0), c(1e30, 1, 1);
  EXPECT_EQ(side_of_plane(a, b, c, {1e30, 1e-30, 1e-30}), 0);
  EXPECT_EQ(side_of_plane(a, b, c, {std::nextafter(1e30, 2e30), 7, -3}), 1);
  EXPECT_EQ(side_of_plane(a, b, c, {std::nextafter(1e30, 0.0), 7, -3}), -1);
  EXPECT_EQ(turn({0, 0, 0}, {1e20, 1e20, 0}, {1, std::nextafter(1.0, 2.0), 0}, 2), 1);
  EXPECT_EQ(turn({0, 0, 0}, {1e20, 1e20, 0}, {1, 1, 0}, 2), 0);
}

TEST(AxisOfSight, IsOneAlongWhichTheTriangleHasAnArea) {
  EXPECT_EQ(axis_of_sight({Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}), 0);
  EXPECT_EQ(axis_of_sight({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 0, 1)}), 1);
  EXPECT_EQ(axis_of_sight({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}), 2);
}

TEST(AxisOfSight, OfATriangleWithoutAnAreaThereIsNone) {
  EXPECT_EQ(axis_of_sight({Vec3(0, 0, 0), Vec3(1, 2, 3), Vec3(3, 6, 9)}), -1);
  EXPECT_EQ(axis_of_sight({Vec3(1, 1, 1), Vec3(1, 1, 1), Vec3(3, 6, 9)}), -1);
  EXPECT_EQ(axis_of_sight({Vec3(1, 1, 1), Vec3(1, 1, 1), Vec3(1, 1, 1)}), -1);
}

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
