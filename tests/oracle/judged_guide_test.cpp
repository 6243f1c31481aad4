// SPDX-License-Identifier: BSD-3-Clause
// The judge's regions by hand, and beside the library's, which share no code.
#include "keepout/oracle/judged_guide.h"

#include <gtest/gtest.h>

#include <cmath>

#include "keepout/fixtures/random.h"
#include "keepout/geometry/region.h"

namespace keepout::oracle {
namespace {

using Kind = JudgedGuide::Kind;
using Region = JudgedGuide::Region;

std::vector<LinkFrame> world() { return place({}, {}, {}); }

TEST(JudgedGuide, RegionsAreWhatTheyAreByHand) {
  const JudgedGuide slab{.first = {0, Vec3(5.0, 7.0, 1.0)},
                         .region = Region::slab,
                         .direction = Vec3::UnitX(),
                         .radius = 2.0};
  EXPECT_DOUBLE_EQ(excess(slab, world()), 3.0);
  JudgedGuide half_space = slab;
  half_space.region = Region::half_space;
  half_space.radius = 0.0;
  EXPECT_DOUBLE_EQ(excess(half_space, world()), -5.0);
  JudgedGuide tube = slab;
  tube.region = Region::tube;
  EXPECT_DOUBLE_EQ(excess(tube, world()), std::sqrt(50.0) - 2.0);
  JudgedGuide ball = slab;
  ball.region = Region::ball;
  EXPECT_DOUBLE_EQ(excess(ball, world()), std::sqrt(75.0) - 2.0);
}

TEST(JudgedGuide, AxesAndShaftsAreWhatTheyAreByHand) {
  const double angle = 0.3;
  const JudgedGuide axis{.kind = Kind::axis,
                         .first = {0, Vec3(std::cos(angle), std::sin(angle), 0.0)},
                         .origin = Vec3::UnitX(),
                         .radius = 2.0 * std::sin(0.05)};
  EXPECT_DOUBLE_EQ(excess(axis, world()), 2.0 * std::sin(0.15) - 2.0 * std::sin(0.05));
  JudgedGuide shaft{.kind = Kind::remote_center,
                    .first = {0, Vec3(0.0, 0.0, 0.0)},
                    .second = {0, Vec3(10.0, 0.0, 0.0)},
                    .origin = Vec3(4.0, 3.0, 0.0),
                    .radius = 1.0};
  EXPECT_DOUBLE_EQ(excess(shaft, world()), 2.0);
  shaft.origin = Vec3(13.0, 4.0, 0.0);  // beyond its end
  EXPECT_DOUBLE_EQ(excess(shaft, world()), 4.0);
}

TEST(JudgedGuide, ExcessIsThatOfTheLibrary) {
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 origin = random.uniform(0.0, 10.0) * random.direction();
    const Vec3 direction = random.direction();
    const double radius = random.uniform(0.1, 5.0);
    const Vec3 point = random.uniform(0.0, 10.0) * random.direction();
    JudgedGuide judged{
        .first = {0, point}, .origin = origin, .direction = direction, .radius = radius};
    const auto expect = [&](Region kind, const keepout::Region& region) {
      judged.region = kind;
      EXPECT_NEAR(excess(judged, world()), region.excess(point), 1e-13);
    };
    expect(Region::slab, keepout::Region::slab(origin, direction, radius));
    expect(Region::tube, keepout::Region::tube(origin, direction, radius));
    expect(Region::ball, keepout::Region::ball(origin, radius));
    judged.radius = 0.0;
    expect(Region::half_space, keepout::Region::half_space(origin, direction));
  }
}

}  // namespace
}  // namespace keepout::oracle
