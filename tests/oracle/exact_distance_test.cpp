// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "keepout/oracle/safety_oracle.h"
#include "meshes.h"
#include "oracle/hostile_pairs.h"
#include "trials.h"

namespace keepout::oracle {
namespace {

/// Fails unless the exact distance is `distance`. The next double above and below must compare as
/// different.
void expect_exactly(const Segment& segment, const Triangle& triangle, double distance) {
  const ExactDistance exact = exact_distance(segment, triangle, distance);
  EXPECT_TRUE(exact.against_threshold == 0) << exact.distance << " instead of " << distance;
  EXPECT_EQ(exact.against_zero == 0, distance == 0.0);
  EXPECT_NEAR(exact.distance, distance, 1e-15 * distance);
  const double above = std::nextafter(distance, test::infinity);
  EXPECT_TRUE(exact_distance(segment, triangle, above).against_threshold < 0);
  if (distance == 0.0) return;
  const double under = std::nextafter(distance, 0.0);
  EXPECT_TRUE(exact_distance(segment, triangle, under).against_threshold > 0);
}

struct Known {
  Segment segment;
  Triangle triangle;
  double distance;
};

const Triangle right_angle{Vec3(0, 0, 0), Vec3(12, 0, 0), Vec3(0, 12, 0)};

/// One pair with integer coordinates for each combination of nearest features. Some triangles are a
/// point or a line.
const std::array known_pairs{
    Known{{{1, 1, 5}, {1, 1, 9}}, right_angle, 5},    // an end above the face
    Known{{{2, 2, -9}, {1, 1, -3}}, right_angle, 3},  // the other end, below the face
    Known{{{1, 1, 4}, {3, 2, 4}}, right_angle, 4},    // parallel to the face
    Known{{{3, 3, 7}, {3, 3, 7}}, right_angle, 7},    // a point above the face
    Known{{{5, -3, 4}, {5, -6, 8}}, right_angle, 5},  // an end off an edge
    Known{{{-2, -3, 1}, {9, -3, 1}}, {Vec3(0, 0, 1), Vec3(5, 0, 1), Vec3(2, 7, 1)}, 3},  // parallel
    Known{{{4, -3, -7}, {4, -3, 9}}, right_angle, 3},    // crosses an edge at a distance
    Known{{{15, -4, -9}, {15, -4, 9}}, right_angle, 5},  // passes by a corner
    Known{{{14, -3, 6}, {20, -3, 9}}, right_angle, 7},   // an end off a corner
    Known{{{2, 2, -5}, {2, 2, 3}}, right_angle, 0},      // pierces the face
    Known{{{2, 2, 0}, {2, 2, 3}}, right_angle, 0},       // ends on the face
    Known{{{6, 6, -1}, {6, 6, 1}}, right_angle, 0},      // through an edge
    Known{{{5, -1, -1}, {5, 1, 1}}, right_angle, 0},     // through another edge, at an angle
    Known{{{12, 0, -2}, {12, 0, 2}}, right_angle, 0},    // through a corner
    Known{{{11, -1, 1}, {13, 1, -1}}, right_angle, 0},   // through a corner, at an angle
    Known{{{-3, 4, 0}, {20, 4, 0}}, right_angle, 0},     // in the plane, across
    Known{{{1, 1, 0}, {3, 2, 0}}, right_angle, 0},       // in the plane, inside
    Known{{{-4, 0, 0}, {-1, 0, 0}}, right_angle, 1},     // in the plane, in line with an edge
    Known{{{-4, 0, 0}, {5, 0, 0}}, right_angle, 0},      // along an edge
    Known{{{-4, 4, 0}, {4, -4, 0}}, right_angle, 0},     // in the plane, only through a corner
    Known{{{9, 9, 0}, {9, 9, 0}}, {Vec3(9, 0, 0), Vec3(9, 9, 0), Vec3(0, 9, 0)}, 0},   // corner
    Known{{{3, 0, 4}, {9, 0, 12}}, {Vec3(0, 0, 0), Vec3(0, 0, 0), Vec3(0, 0, 0)}, 5},  // a point
    Known{{{0, 0, 0}, {0, 0, 0}}, {Vec3(0, 0, 0), Vec3(0, 0, 0), Vec3(0, 0, 0)}, 0},
    Known{{{5, 6, -2}, {5, 6, 8}}, {Vec3(0, 0, 0), Vec3(9, 0, 0), Vec3(4, 0, 0)}, 6},  // a line
    Known{{{5, -6, 0}, {5, 6, 0}}, {Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(9, 0, 0)}, 0},
    Known{{{5, -6, 2}, {5, 6, 2}}, {Vec3(0, 0, 0), Vec3(9, 0, 0), Vec3(9, 0, 0)}, 2},
};

TEST(ExactDistance, OfEachPairOfFeaturesIsExactToTheLastPlace) {
  for (const Known& known : known_pairs) {
    SCOPED_TRACE(&known - known_pairs.data());
    expect_exactly(known.segment, known.triangle, known.distance);
    expect_exactly({known.segment.to, known.segment.from}, known.triangle, known.distance);
    expect_exactly(known.segment, {known.triangle[1], known.triangle[0], known.triangle[2]},
                   known.distance);
  }
}

/// A rotation times k = a^2 + b^2 + c^2 + d^2, with integer entries (Euler parameters).
struct Turned {
  Eigen::Matrix3d by;
  double factor;
};

Turned random_turn(Random& random) {
  const auto whole = [&] { return static_cast<double>(random.below(41)) - 20.0; };
  const double a = whole(), b = whole(), c = whole(), d = 1.0 + std::abs(whole());
  Turned turned{{}, a * a + b * b + c * c + d * d};
  turned.by << a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c),
      2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b), 2 * (b * d - a * c),
      2 * (c * d + a * b), a * a - b * b - c * c + d * d;
  return turned;
}

TEST(ExactDistance, StaysExactWhenTheWorldIsTurnedScaledAndMovedByWholeNumbers) {
  Random random(20261120);
  for (int i = 0; i < 200; ++i) {
    const Turned turned = random_turn(random);
    const double unit = std::ldexp(1.0, static_cast<int>(random.below(41)) - 20);
    const Vec3 offset = 1e6 * unit * Vec3(1, -2, 3) * static_cast<double>(random.below(2));
    const auto place = [&](const Vec3& v) -> Vec3 { return unit * (turned.by * v) + offset; };
    for (const Known& known : known_pairs) {
      SCOPED_TRACE(&known - known_pairs.data());
      const auto& [s, t, distance] = known;
      expect_exactly({place(s.from), place(s.to)}, {place(t[0]), place(t[1]), place(t[2])},
                     unit * turned.factor * distance);
    }
  }
}

// An independent computation: a search in 113-bit arithmetic. The distance of a point of the
// segment from the triangle is a convex function of its position on the segment.
using Quad = __float128;
using Quad3 = std::array<Quad, 3>;

Quad3 operator-(const Quad3& a, const Quad3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Quad3 along(const Quad3& a, const Quad3& way, Quad s) {
  return {a[0] + s * way[0], a[1] + s * way[1], a[2] + s * way[2]};
}
Quad dot(const Quad3& a, const Quad3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Quad3 cross(const Quad3& a, const Quad3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Quad3 quad(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Quad squared_distance(const std::array<Quad3, 3>& t, const Quad3& point) {
  Quad best = dot(point - t[0], point - t[0]);
  for (int i = 0; i < 3; ++i) {
    const Quad3 side = t[(i + 1) % 3] - t[i];
    const Quad side2 = dot(side, side);
    Quad s = side2 > 0 ? dot(point - t[i], side) / side2 : 0;
    s = std::clamp(s, Quad(0), Quad(1));
    const Quad3 offset = point - along(t[i], side, s);
    best = std::min(best, dot(offset, offset));
  }
  const Quad3 u = t[1] - t[0], v = t[2] - t[0], w = point - t[0];
  const Quad3 normal = cross(u, v);
  const Quad normal2 = dot(normal, normal);
  const Quad b = dot(cross(w, v), normal), c = dot(cross(u, w), normal);
  if (normal2 > 0 && b >= 0 && c >= 0 && b + c <= normal2) {
    best = std::min(best, dot(w, normal) * dot(w, normal) / normal2);
  }
  return best;
}

double searched_distance(const HostilePair& pair) {
  const Quad3 from = quad(pair.segment.from);
  const Quad3 way = quad(pair.segment.to) - from;
  const std::array<Quad3, 3> t{quad(pair.triangle[0]), quad(pair.triangle[1]),
                               quad(pair.triangle[2])};
  Quad low = 0, high = 1;
  for (int i = 0; i < 120; ++i) {  // (2/3)^120 = 7e-22
    const Quad third = (high - low) / 3;
    const Quad one = squared_distance(t, along(from, way, low + third));
    const Quad other = squared_distance(t, along(from, way, high - third));
    (one < other ? high : low) = one < other ? high - third : low + third;
  }
  const Quad best = std::min({squared_distance(t, along(from, way, (low + high) / 2)),
                              squared_distance(t, from), squared_distance(t, along(from, way, 1))});
  return std::sqrt(static_cast<double>(best));
}

TEST(ExactDistance, AgreesWithASearchInQuadruplePrecisionOnHostilePairs) {
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const HostilePair pair = hostile_pair(random);
    double size = (pair.segment.to - pair.segment.from).norm();
    for (const Vec3& corner : pair.triangle) {
      size = std::max(size, (corner - pair.segment.from).norm());
    }
    const double distance = exact_distance(pair.segment, pair.triangle, 0.0).distance;
    ASSERT_NEAR(distance, searched_distance(pair), 1e-15 * distance + 1e-14 * size) << "pair " << i;
  }
}

double size_of(const HostilePair& pair) {
  double size = (pair.segment.to - pair.segment.from).lpNorm<1>();
  for (const Vec3& corner : pair.triangle) {
    size = std::max(size, (corner - pair.segment.from).lpNorm<1>());
  }
  return size;
}

TEST(BracketDistance, HoldsTheExactDistanceOfHostilePairs) {
  Random random(20261120);
  for (int i = 0; i < test::trials(30'000); ++i) {
    const HostilePair pair = hostile_pair(random);
    const Bracket bracket = bracket_distance(pair.segment, pair.triangle);
    ASSERT_LE(bracket.low, bracket.estimate);
    ASSERT_LE(bracket.estimate, bracket.high);
    ASSERT_TRUE(exact_distance(pair.segment, pair.triangle, bracket.low).against_threshold >= 0)
        << "pair " << i;
    ASSERT_TRUE(exact_distance(pair.segment, pair.triangle, bracket.high).against_threshold <= 0)
        << "pair " << i;
  }
}

TEST(NarrowDistance, IsWithinABillionthOfTheExactOneAndZeroOnlyAtATouch) {
  Random random(2);
  for (int i = 0; i < test::trials(40'000); ++i) {
    const HostilePair pair = hostile_pair(random);
    const Bracket narrow = narrow_distance(pair.segment, pair.triangle);
    const ExactDistance exact = exact_distance(pair.segment, pair.triangle, 0.0);
    ASSERT_TRUE(narrow.narrow());
    ASSERT_NEAR(narrow.estimate, exact.distance, 1e-9 * exact.distance) << "pair " << i;
    ASSERT_EQ(narrow.estimate == 0.0, exact.against_zero == 0) << "pair " << i;
    ASSERT_EQ(narrow.low == 0.0, exact.against_zero == 0) << "pair " << i;
  }
}

TEST(BracketDistance, IsNarrowForNearlyAllFairPairs) {
  Random random(3);
  const auto point = [&random]() -> Vec3 { return 10.0 * random.direction() * random.uniform(); };
  int wide = 0;
  const int count = test::trials(1'000'000);
  for (int i = 0; i < count; ++i) {
    HostilePair pair;
    pair.triangle = {point(), point(), point()};
    pair.segment.from = point();
    pair.segment.to = pair.segment.from + 0.2 * random.direction();
    const Bracket bracket = bracket_distance(pair.segment, pair.triangle);
    if (bracket.high < 1e-6) continue;
    if (bracket.high - bracket.low > 0x1p-46 * size_of(pair)) ++wide;
  }
  EXPECT_LT(wide, count / 1000);
}

TEST(BracketDistance, OfPairsBeyondItsRangeIsLeftOpen) {
  const Triangle triangle{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  for (const double unit : {1e-200, 1e200}) {
    const Triangle scaled{unit * triangle[0], unit * triangle[1], unit * triangle[2]};
    const Segment segment{unit * Vec3(0.25, 0.25, 1), unit * Vec3(0.25, 0.25, 2)};
    const Bracket bracket = bracket_distance(segment, scaled);
    EXPECT_EQ(bracket.low, 0.0);
    EXPECT_EQ(bracket.high, test::infinity);
    EXPECT_DOUBLE_EQ(exact_distance(segment, scaled, 0.0).distance, unit);
  }
}

/// Fails unless the oracle of a mesh with one triangle agrees with the exact distance.
void expect_exact_verdict(const HostilePair& pair, double threshold, SafetyOracle& oracle) {
  const Finding finding = oracle.check(pair.segment.from, pair.segment.to, threshold);
  const ExactDistance exact = exact_distance(pair.segment, pair.triangle, threshold);
  ASSERT_EQ(finding.crosses, exact.against_zero == 0) << threshold;
  ASSERT_EQ(finding.below, exact.against_threshold < 0) << threshold;
  ASSERT_EQ(finding.crosses, finding.distance == 0.0);
  if (finding.below) {
    ASSERT_LE(finding.distance, threshold);
  } else {
    ASSERT_GE(finding.distance, threshold);
  }
}

TEST(BracketDistance, AndTheExactOneNeverDisagreeOneStepAroundTheTruth) {
  Random random(4);
  for (int i = 0; i < test::trials(8'000); ++i) {
    const HostilePair pair = hostile_pair(random);
    const auto& [a, b, c] = pair.triangle;
    SafetyOracle oracle(mesh_of(Surface{{a, b, c}, {{0, 1, 2}}}));
    const double truth = exact_distance(pair.segment, pair.triangle, 0.0).distance;
    const Bracket bracket = bracket_distance(pair.segment, pair.triangle);
    for (const double threshold :
         {0.0, truth, std::nextafter(truth, 0.0), std::nextafter(truth, test::infinity),
          bracket.low, std::nextafter(bracket.high, test::infinity),
          truth * random.uniform(0.0, 2.0)}) {
      expect_exact_verdict(pair, threshold, oracle);
      if (HasFatalFailure()) FAIL() << "pair " << i;
    }
  }
}

}  // namespace
}  // namespace keepout::oracle
