// SPDX-License-Identifier: BSD-3-Clause
#include "gap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/geometry/separation.h"
#include "trials.h"

namespace keepout {
namespace {

Triangle random_triangle(Random& random) {
  const Vec3 at = 5.0 * random.direction();
  const double size = std::pow(10.0, random.uniform(-2.0, 1.0));
  const double width = std::pow(10.0, random.uniform(-6.0, 0.0));
  const Vec3 along = size * random.direction();
  return {at, at + along, at + random.uniform() * along + width * size * random.direction()};
}

double least_height(const std::vector<Vec3>& core, const Vec3& n) {
  double least = n.dot(core[0]);
  for (const Vec3& point : core) least = std::min(least, n.dot(point));
  return least;
}

// The judge is a search among the planes and pairs of points, which shares nothing but
// closest_point.
TEST(Gap, IsTheDistanceOfTheHullAndProvenByItsPlane) {
  Random random(1);
  int touching = 0;
  for (int i = 0; i < test::trials(40'000); ++i) {
    const Triangle triangle = random_triangle(random);
    std::vector<Vec3> core;
    const std::size_t count = 1 + random.below(4);
    for (std::size_t p = 0; p < count; ++p) {
      core.push_back(5.0 * random.direction() * (random.below(4) == 0 ? 0.01 : 1.0));
    }
    const Gap found = gap(core, triangle);
    const Separation truth = separation(ConvexTool::hull(core), Vec3::Zero(), triangle);
    ASSERT_NEAR(found.distance, std::max(truth.distance, 0.0), 1e-11) << "trial " << i;
    if (!(found.distance > 0.0)) {
      ++touching;
      continue;
    }
    ASSERT_NEAR(found.normal.norm(), 1.0, 1e-14);
    const double behind = std::max({found.normal.dot(triangle[0]), found.normal.dot(triangle[1]),
                                    found.normal.dot(triangle[2])});
    ASSERT_LE(found.distance, least_height(core, found.normal) - behind + 1e-14);
    ASSERT_NEAR(found.normal.dot(found.contact) - behind, found.distance, 1e-6);
  }
  EXPECT_GT(touching, test::trials(100));
}

TEST(Gap, OfASegmentAlongATriangleIsSharp) {
  const Triangle triangle{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  for (const double tilt : {0.0, 1e-15, 1e-12, 1e-9, 1e-6}) {
    const std::vector<Vec3> core{Vec3(-100, 0.2, 0.5), Vec3(100, 0.3, 0.5 + 200.0 * tilt)};
    EXPECT_NEAR(gap(core, triangle).distance, 0.5 + 99.0 * tilt, 2e-12 + 3.0 * tilt) << tilt;
  }
}

TEST(Gap, OfWhatGoesThroughOrTouchesIsNone) {
  const Triangle triangle{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
  for (const auto& [from, to] :
       {std::pair{Vec3(1, 1, -1), Vec3(1, 1, 3)}, std::pair{Vec3(1, 1, -50), Vec3(1, 1, 0)},
        std::pair{Vec3(-1, 1, 0), Vec3(5, 1, 0)}, std::pair{Vec3(0, 0, -1), Vec3(0, 0, 1)}}) {
    const std::vector<Vec3> core{from, to};
    EXPECT_EQ(gap(core, triangle).distance, 0.0);
    EXPECT_EQ(gap(core, triangle).normal, Vec3::Zero().eval());
  }
}

TEST(Gap, OfATriangleWithoutAnAreaIsThatOfItsSegment) {
  const Triangle segment{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(1, 0, 0)};
  const Triangle point{Vec3(1, 0, 0), Vec3(1, 0, 0), Vec3(1, 0, 0)};
  const std::vector<Vec3> core{Vec3(1, -3, 2), Vec3(1, 3, 2)};
  EXPECT_NEAR(gap(core, segment).distance, 2.0, 1e-15);
  EXPECT_NEAR(gap(core, point).distance, 2.0, 1e-15);
}

}  // namespace
}  // namespace keepout
