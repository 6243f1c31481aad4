// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/region.h"

#include <cmath>

#include "keepout/error.h"
#include "keepout/fixtures/random.h"
#include "trials.h"

namespace keepout {
namespace {

std::vector<Region> some_regions(Random& random) {
  const Vec3 at = 10.0 * random.direction();
  const Vec3 way = random.uniform(0.1, 9.0) * random.direction();
  const double size = random.uniform(0.1, 3.0);
  return {Region::half_space(at, way), Region::slab(at, way, size), Region::tube(at, way, size),
          Region::ball(at, size)};
}

TEST(Region, MeasuresHowFarAPointIsOutOfIt) {
  const Vec3 at(1, 2, 3);
  const Vec3 z(0, 0, 5);
  EXPECT_DOUBLE_EQ(Region::half_space(at, z).excess(Vec3(9, 9, 1)), 2.0);
  EXPECT_DOUBLE_EQ(Region::half_space(at, z).excess(Vec3(9, 9, 7)), -4.0);
  EXPECT_DOUBLE_EQ(Region::slab(at, z, 1.0).excess(Vec3(9, 9, 5)), 1.0);
  EXPECT_DOUBLE_EQ(Region::slab(at, z, 1.0).excess(Vec3(9, 9, 1)), 1.0);
  EXPECT_DOUBLE_EQ(Region::tube(at, z, 1.0).excess(Vec3(4, 6, 77)), 4.0);
  EXPECT_DOUBLE_EQ(Region::ball(at, 1.0).excess(Vec3(1, 5, 7)), 4.0);
  EXPECT_DOUBLE_EQ(Region::ball(at, 1.0).excess(at), -1.0);
  EXPECT_TRUE(Region::ball(at, 1.0).outward(at).isZero(0.0));
  EXPECT_EQ(Region::tube(at, z, 1.0).kind(), Region::Kind::tube);
  EXPECT_EQ(Region::tube(at, z, 1.0).direction(), Vec3::UnitZ());
}

// The proof of guides requires that the excess is convex with a slope of at most 1. The region must
// also be behind the planes along `outward`.
TEST(Region, HasAnExcessThatIsConvexAndNoSteeperThanOne) {
  Random random(1);
  for (int i = 0; i < test::trials(20'000); ++i) {
    for (const Region& region : some_regions(random)) {
      const Vec3 a = 20.0 * random.direction();
      const Vec3 b = 20.0 * random.direction();
      const double share = random.uniform();
      const double between = region.excess(a + share * (b - a));
      EXPECT_LE(between, (1.0 - share) * region.excess(a) + share * region.excess(b) + 1e-12);
      EXPECT_LE(std::abs(region.excess(a) - region.excess(b)), (a - b).norm() + 1e-12);
      const Vec3 out = region.outward(a);
      ASSERT_NEAR(out.norm(), 1.0, 1e-12);
      // Near the middle, rounding dominates the small difference that gives the direction.
      const double rounding = 1e-12 + 1e-13 / std::abs(region.excess(a) + region.radius());
      EXPECT_NEAR(out.dot(a - region.origin()) - region.radius(), region.excess(a), rounding);
      EXPECT_LE(out.dot(b - region.origin()) - region.radius(), region.excess(b) + rounding);
    }
  }
}

TEST(Region, RefusesWhatIsNone) {
  const Vec3 at = Vec3::Zero();
  EXPECT_THROW(Region::half_space(at, Vec3::Zero()), Error);
  EXPECT_THROW(Region::slab(at, Vec3(test::nan, 0, 0), 1.0), Error);
  EXPECT_THROW(Region::slab(at, Vec3::UnitX(), 0.0), Error);
  EXPECT_THROW(Region::tube(at, Vec3::UnitX(), -1.0), Error);
  EXPECT_THROW(Region::tube(Vec3(test::nan, 0, 0), Vec3::UnitX(), 1.0), Error);
  EXPECT_THROW(Region::ball(Vec3(1e300, 0, 0), 1.0), Error);
  EXPECT_THROW(Region::ball(at, test::nan), Error);
}

}  // namespace
}  // namespace keepout
