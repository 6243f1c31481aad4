// SPDX-License-Identifier: BSD-3-Clause
// Compares PreparedTriangle with the oracle, whose distances share no code with the engine, and
// with dense samples.
#include "keepout/activation/prepared_triangle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "activation/certified/straight_clearance.h"
#include "keepout/activation/first_contact.h"
#include "keepout/fixtures/random.h"
#include "keepout/geometry/closest_point.h"
#include "keepout/oracle/distance.h"
#include "trials.h"

namespace keepout {
namespace {

bool keeps_clear(const PreparedTriangle& prepared, const Vec3& z, double level, double slack) {
  return proof_of_clearance(prepared, z, level, slack).has_value();
}

Vec3 random_point(Random& random, double size) {
  return size * random.uniform(0.1, 1.0) * random.direction();
}

/// A class of random triangles, with the tolerances that its flatness requires.
struct Kind {
  const char* name;
  double height;    // of the triangle, as a fraction of its base
  double rounding;  // of distances, in sizes of the problem
  double hidden;    // clearance that rounding may hide, in sizes of the problem
};

void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

Triangle random_triangle(Random& random, double size, double height) {
  const Vec3 a = random_point(random, size);
  const Vec3 b = random_point(random, size);
  if (height == 1.0) return {a, b, random_point(random, size)};
  const Vec3 apex = a + random.uniform(-0.2, 1.2) * (b - a);
  const Vec3 up = (b - a).unitOrthogonal() * (b - a).norm() * height;
  return {a, b, apex + up};
}

double size_of(const Triangle& triangle, const Vec3& z) {
  return std::max({triangle[0].norm(), triangle[1].norm(), triangle[2].norm(), z.norm()});
}

double distance_between(const Triangle& triangle, const Vec3& z) {
  const monitor::Segment way{Vec3::Zero(), z};
  const monitor::Bracket bracket = monitor::bracket_distance(way, triangle);
  if (bracket.high - bracket.low < 1e-13 * size_of(triangle, z)) return bracket.estimate;
  return oracle::exact_distance(way, triangle, 0.0).distance;
}

double sampled_distance(const Triangle& triangle, const Vec3& from, const Vec3& to) {
  constexpr int samples = 400;
  double least = test::infinity;
  for (int i = 0; i <= samples; ++i) {
    const Vec3 point = from + static_cast<double>(i) / samples * (to - from);
    least = std::min(least, closest_point(triangle, point).distance);
  }
  return least;
}

/// Returns the free fraction of a motion.
double share_of(const Contact& contact) { return std::clamp(contact.time, 0.0, 1.0); }

class PreparedTriangleOfKind : public testing::TestWithParam<Kind> {};

/// A motion past a random triangle, and a required clearance near the value that decides.
struct Case {
  Triangle triangle;
  Vec3 z;
  double size;
  double slack;
  double distance;  // of the whole motion from the triangle
  double level;
};

Case random_case(Random& random, double height) {
  Case c;
  const double size = std::pow(10.0, random.uniform(-2.0, 2.0));
  c.triangle = random_triangle(random, size, height);
  c.z = random.uniform(0.01, 2.0) * size * random.direction();
  const std::size_t place = random.below(3);
  if (place > 0) {  // start or end right over the face: a random motion past a needle rarely does
    const Vec3 normal = unit_normal(c.triangle);
    const double a = random.uniform(0.0, 0.5);
    const double b = random.uniform(0.0, 0.5);
    const Vec3 inside =
        c.triangle[0] + a * (c.triangle[1] - c.triangle[0]) + b * (c.triangle[2] - c.triangle[0]);
    const Vec3 over = inside + random.uniform(0.01, 1.0) * size * normal;
    const Vec3 tip = place == 1 ? over : Vec3(over - c.z);
    for (Vec3& corner : c.triangle) corner -= tip;
  }
  if (place == 1 && random.below(2) == 0) {  // almost parallel to an edge
    const Vec3 along = c.triangle[1] - c.triangle[0];
    c.z = random.uniform(-1.0, 1.0) * along + 1e-9 * random.uniform(-1.0, 1.0) * c.z;
  }
  c.size = size_of(c.triangle, c.z);
  c.slack = 4e-12 * c.size;
  c.distance = distance_between(c.triangle, c.z);
  const double at_tip = closest_point(c.triangle, Vec3::Zero()).distance;
  switch (random.below(3)) {
    case 0:
      c.level = random.uniform() * at_tip;
      break;
    case 1:  // within a few slacks of the limit
      c.level = c.distance + random.uniform(-4.0, 4.0) * c.slack;
      break;
    default:
      c.level = c.distance * (1.0 + std::pow(10.0, random.uniform(-9.0, -1.0)));
  }
  // The rule never judges a tip within 4 tolerances: it has no side.
  c.level = std::clamp(c.level, std::min(256.0 * c.slack, at_tip), at_tip);
  return c;
}

/// Calls `check` with random cases and their prepared triangles. Failures report the case number.
template <class Check>
void for_each_case(std::uint64_t seed, int cases, double height, const Check& check) {
  Random random(seed);
  for (int i = 0; i < test::trials(cases); ++i) {
    const Case c = random_case(random, height);
    SCOPED_TRACE(i);
    check(c, PreparedTriangle(c.triangle, Vec3::Zero(), 7), random);
    if (testing::Test::HasFatalFailure()) return;
  }
}

TEST_P(PreparedTriangleOfKind, WhatIsSaidToKeepClearDoes) {
  std::size_t clear = 0;
  for_each_case(1, 30'000, GetParam().height,
                [&](const Case& c, const PreparedTriangle& prepared, Random&) {
                  if (!keeps_clear(prepared, c.z, c.level, c.slack)) return;
                  ++clear;
                  ASSERT_GE(c.distance, c.level - c.slack - GetParam().rounding * c.size);
                });
  EXPECT_GT(clear, test::trials(5'000u));
}

TEST_P(PreparedTriangleOfKind, WhatKeepsClearIsSaidTo) {
  std::size_t kept = 0;
  for_each_case(2, 30'000, GetParam().height,
                [&](const Case& c, const PreparedTriangle& prepared, Random&) {
                  if (c.distance < c.level - c.slack + GetParam().hidden * c.size) return;
                  ++kept;
                  ASSERT_TRUE(keeps_clear(prepared, c.z, c.level, c.slack));
                });
  EXPECT_GT(kept, test::trials(5'000u));
}

TEST_P(PreparedTriangleOfKind, NoSampleOfAClearMotionIsTooNear) {
  std::size_t clear = 0;
  for_each_case(3, 2'000, GetParam().height,
                [&](const Case& c, const PreparedTriangle& prepared, Random&) {
                  if (!keeps_clear(prepared, c.z, c.level, c.slack)) return;
                  ++clear;
                  ASSERT_GE(sampled_distance(c.triangle, Vec3::Zero(), c.z),
                            c.level - c.slack - GetParam().rounding * c.size);
                });
  EXPECT_GT(clear, test::trials(300u));
}

TEST_P(PreparedTriangleOfKind, TheFirstContactIsNeitherLateNorEarly) {
  std::size_t contacts = 0;
  for_each_case(
      4, 30'000, GetParam().height, [&](const Case& c, const PreparedTriangle& prepared, Random&) {
        const double rounding = GetParam().rounding * c.size;
        if (keeps_clear(prepared, c.z, c.level, c.slack)) return;
        ++contacts;
        const Contact contact = first_contact(prepared, c.z, c.level, c.slack, 1.0);
        const double share = share_of(contact);
        ASSERT_GE(distance_between(c.triangle, share * c.z), c.level - rounding) << "goes past it";
        const double there = closest_point(c.triangle, share * c.z).distance;
        ASSERT_LE(there, c.level + c.slack + rounding) << "stops before it";

        const HalfSpace& plane = contact.plane;
        ASSERT_EQ(plane.source, 7u);
        ASSERT_NEAR(plane.normal.norm(), 1.0, 1e-15);
        ASSERT_LE(plane.offset, rounding) << "the tip may not stay";
        for (const Vec3& corner : c.triangle) {
          ASSERT_LE(plane.normal.dot(corner) + c.level, plane.offset + 1e-15 * c.size);
        }
      });
  EXPECT_GT(contacts, test::trials(2'000u));
}

TEST_P(PreparedTriangleOfKind, ThePlaneOfAContactExcludesTheMotion) {
  std::size_t contacts = 0;
  for_each_case(5, 30'000, GetParam().height,
                [&](const Case& c, const PreparedTriangle& prepared, Random&) {
                  // The rule rejects a motion only if the clearance falls an eighth of a tolerance
                  // (8 slacks) below the level.
                  const double demand = c.level - 8.0 * c.slack;
                  if (demand <= 0.0 || keeps_clear(prepared, c.z, demand, 0.125 * c.slack)) return;
                  ++contacts;
                  const HalfSpace plane = first_contact(prepared, c.z, c.level, c.slack, 1.0).plane;
                  ASSERT_LT(plane.normal.dot(c.z), plane.offset);
                });
  EXPECT_GT(contacts, test::trials(2'000u));
}

TEST_P(PreparedTriangleOfKind, TheSearchForALateContactIsGivenUpOnlyBeyondTheLatest) {
  for_each_case(6, 20'000, GetParam().height,
                [&](const Case& c, const PreparedTriangle& prepared, Random& r) {
                  if (keeps_clear(prepared, c.z, c.level, c.slack)) return;
                  const Contact whole = first_contact(prepared, c.z, c.level, c.slack, 1.0);
                  // Half of the searches end exactly at the contact. There, two features may tie,
                  // and either may be found first.
                  const double latest = r.below(2) == 0 ? r.uniform() : whole.time;
                  const Contact some = first_contact(prepared, c.z, c.level, c.slack, latest);
                  if (whole.time <= latest) {
                    ASSERT_EQ(some.time, whole.time) << "given up too soon";
                    ASSERT_EQ(some.plane.normal, whole.plane.normal);
                  } else {
                    ASSERT_GT(some.time, latest);
                  }
                });
}

TEST_P(PreparedTriangleOfKind, TheOrderOfTheCornersDoesNotMatter) {
  for_each_case(
      7, 5'000, GetParam().height, [&](const Case& c, const PreparedTriangle& prepared, Random&) {
        std::array<int, 3> order{0, 1, 2};
        while (std::next_permutation(order.begin(), order.end())) {
          const Triangle other{c.triangle[order[0]], c.triangle[order[1]], c.triangle[order[2]]};
          const PreparedTriangle same(other, Vec3::Zero(), 9);
          ASSERT_EQ(same.distance(), prepared.distance());
          ASSERT_EQ(same.towards_tip(), prepared.towards_tip());
          ASSERT_EQ(keeps_clear(same, c.z, c.level, c.slack),
                    keeps_clear(prepared, c.z, c.level, c.slack));
          ASSERT_EQ(first_contact(same, c.z, c.level, c.slack, 1.0).time,
                    first_contact(prepared, c.z, c.level, c.slack, 1.0).time);
          ASSERT_FALSE(same.before(prepared));
          ASSERT_FALSE(prepared.before(same));
        }
      });
}

TEST_P(PreparedTriangleOfKind, TheNormalPointsFromTheClosestPoint) {
  for_each_case(
      8, 20'000, GetParam().height, [&](const Case& c, const PreparedTriangle& prepared, Random&) {
        const auto nearest = prepared.nearest_to(c.z);
        const double distance = nearest.distance;
        const Vec3& n = nearest.normal;
        if (distance < 1e-3 * c.size) return;
        ASSERT_NEAR(distance, closest_point(c.triangle, c.z).distance, 1e-14 * c.size);
        // The whole triangle is behind the plane, which proves that the point is the closest.
        ASSERT_LE(prepared.support(n) + distance, n.dot(c.z) + GetParam().rounding * c.size);
      });
}

INSTANTIATE_TEST_SUITE_P(Triangles, PreparedTriangleOfKind,
                         testing::Values(Kind{"any", 1.0, 1e-13, 1e-13},
                                         Kind{"flat", 1e-3, 1e-12, 1e-12},
                                         Kind{"needle", 1e-6, 1e-12, 2e-11},
                                         Kind{"hair", 1e-9, 1e-12, 4e-11},
                                         Kind{"segment", 0.0, 1e-12, 4e-11}),
                         by_name);

const Triangle flat{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};

TEST(PreparedTriangle, AMotionAlongIsClearAndOneThroughIsNot) {
  const PreparedTriangle prepared(flat, Vec3(1, 1, 0.5), 3);
  EXPECT_EQ(prepared.distance(), 0.5);
  EXPECT_EQ(prepared.towards_tip(), Vec3(0, 0, 1));
  EXPECT_TRUE(keeps_clear(prepared, Vec3(1, 0, 0), 0.5, 0.0));
  EXPECT_TRUE(keeps_clear(prepared, Vec3(1, 0, -0.25), 0.25, 0.0));
  EXPECT_FALSE(keeps_clear(prepared, Vec3(1, 0, -0.25), 0.26, 0.0));
  EXPECT_FALSE(keeps_clear(prepared, Vec3(0, 0, -1), 0.5, 0.0));
  EXPECT_FALSE(keeps_clear(prepared, Vec3(0, 0, -1), 0.1, 0.0)) << "both ends are clear";
}

TEST(PreparedTriangle, ItsNormalIsOnThePointsSide) {
  const PreparedTriangle above(flat, Vec3(1, 1, 0.5), 3);
  const PreparedTriangle below(flat, Vec3(1, 1, -0.5), 3);
  EXPECT_EQ(above.towards_tip(), Vec3(0, 0, 1));
  EXPECT_EQ(below.towards_tip(), Vec3(0, 0, -1));
}

TEST(PreparedTriangle, AContactStraightDownIsWhereTheLevelIs) {
  const PreparedTriangle prepared(flat, Vec3(1, 1, 1), 3);
  const Contact contact = first_contact(prepared, Vec3(0.1, 0.2, -2), 0.25, 1e-12, 1.0);
  EXPECT_NEAR(contact.time, 0.375, 1e-15);
  EXPECT_EQ(contact.plane.normal, Vec3(0, 0, 1));
  EXPECT_NEAR(contact.plane.offset, -0.75, 1e-15);
}

TEST(PreparedTriangle, AMotionPastACornerTouchesItFromTheSide) {
  // The motion is along x, 0.3 above the corner, and ends straight over it.
  const PreparedTriangle prepared({Vec3(0, 0, 0), Vec3(1, 1, -1), Vec3(1, -1, -1)},
                                  Vec3(-2, 0, 0.3), 3);
  EXPECT_TRUE(keeps_clear(prepared, Vec3(2, 0, 0), 0.3, 1e-12));
  EXPECT_FALSE(keeps_clear(prepared, Vec3(2, 0, 0), 0.31, 1e-12));
  const Contact contact = first_contact(prepared, Vec3(2, 0, 0), 0.5, 1e-12, 1.0);
  EXPECT_NEAR(contact.time, (2 - 0.4) / 2, 1e-12);
  EXPECT_LT((contact.plane.normal - Vec3(-0.8, 0, 0.6)).norm(), 1e-10);
}

TEST(PreparedTriangle, StandingStillAndLeavingAreAlwaysClear) {
  Random random(9);
  for (int i = 0; i < test::trials(10'000); ++i) {
    const Triangle triangle = random_triangle(random, 1.0, i % 2 == 0 ? 1.0 : 1e-3);
    const PreparedTriangle prepared(triangle, Vec3::Zero(), 0);
    ASSERT_TRUE(keeps_clear(prepared, Vec3::Zero(), prepared.distance(), 1e-12));
    ASSERT_TRUE(keeps_clear(prepared, random.uniform() * prepared.towards_tip(),
                            prepared.distance(), 1e-12));
  }
}

TEST(PreparedTriangle, WhatSeparatesKeepsClear) {
  std::size_t separated = 0;
  for_each_case(10, 100'000, 1.0,
                [&](const Case& c, const PreparedTriangle& prepared, Random& random) {
                  if (!separates(random.direction(), prepared.corners(), c.z, c.level, c.slack))
                    return;
                  ++separated;
                  ASSERT_GE(c.distance, c.level - c.slack - 1e-13 * c.size);
                  ASSERT_TRUE(keeps_clear(prepared, c.z, c.level, 2.0 * c.slack));
                });
  EXPECT_GT(separated, test::trials(1'000u));
}

TEST(PreparedTriangle, TheOrderOfPreparedTrianglesIsThatOfTheirCorners) {
  Random random(11);
  for (int i = 0; i < 1'000; ++i) {
    const PreparedTriangle a(random_triangle(random, 1.0, 1.0), Vec3::Zero(), 0);
    const PreparedTriangle b(random_triangle(random, 1.0, 1.0), Vec3::Zero(), 1);
    ASSERT_NE(a.before(b), b.before(a));
    ASSERT_FALSE(a.before(a));
  }
}

TEST(PreparedTriangle, TheOriginMayBeFarOff) {
  Random random(12);
  const Vec3 far(1e6, -2e6, 5e5);
  for (int i = 0; i < test::trials(10'000); ++i) {
    const Case c = random_case(random, 1.0);
    Triangle moved;
    for (int k = 0; k < 3; ++k) moved[k] = c.triangle[k] + far;
    const PreparedTriangle prepared(moved, far, 0);
    ASSERT_NEAR(prepared.distance(), closest_point(c.triangle, Vec3::Zero()).distance, 1e-9);
  }
}

}  // namespace
}  // namespace keepout
