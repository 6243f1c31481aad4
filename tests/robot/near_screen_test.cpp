// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "gap.h"
#include "keepout/fixtures/random.h"
#include "near_blocks.h"
#include "trials.h"

namespace keepout {
namespace {

// Each triangle surrounds the foot of the perpendicular from the core, so that the plane that the
// screen tries is the best one. Then only the slack for rounding keeps the triangle.
TEST(NearScreen, PassesOverNoTriangleWithinTheDistance) {
  Random random(1);
  int passed_over = 0;
  for (int trial = 0; trial < test::trials(5000); ++trial) {
    const Vec3 core = random.uniform(0.0, 1.0) * random.direction();
    const double size = std::pow(10.0, random.uniform(-0.5, 2.0));
    NearBlock block{};
    std::array<double, NearBlock::lanes> distances{};
    for (std::size_t lane = 0; lane < NearBlock::lanes; ++lane) {
      const Vec3 n = random.direction();
      const Vec3 along = size * n.unitOrthogonal();
      const Vec3 foot = core - n;
      const Triangle triangle{foot + along, foot - 0.5 * along + 0.8 * n.cross(along),
                              foot - 0.5 * along - 0.8 * n.cross(along)};
      block.set(lane, triangle, Vec3::Zero());
      distances[lane] = gap({&core, 1}, triangle).distance;
    }
    const double farthest = *std::max_element(distances.begin(), distances.end());
    const NearScreen tight(core, core, farthest * (1.0 + 1e-9), 2.0 * size + 2.0);
    ASSERT_EQ(may_be_near(block, tight), 0xffffu) << size;
    const NearScreen loose(core, core, 0.5, 2.0 * size + 2.0);
    passed_over += std::popcount(0xffffu & ~may_be_near(block, loose));
  }
  EXPECT_GT(passed_over, test::trials(10'000));
}

}  // namespace
}  // namespace keepout
