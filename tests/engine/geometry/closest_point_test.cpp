// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/closest_point.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hostile_triangle.h"
#include "keepout/activation/prepared_triangle.h"
#include "keepout/fixtures/random.h"
#include "trials.h"

namespace keepout {
namespace {

// An independent computation in 113-bit arithmetic, without a shared frame. The nearest point of a
// triangle is the nearest of its seven features, and each is a small linear problem.
using Quad = __float128;
using Quad3 = std::array<Quad, 3>;

Quad3 operator-(const Quad3& a, const Quad3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Quad dot(const Quad3& a, const Quad3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Quad3 quad(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Quad3 cross(const Quad3& a, const Quad3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double independent_distance(const Triangle& triangle, const Vec3& query) {
  std::array<Quad3, 3> p;
  for (int i = 0; i < 3; ++i) p[i] = quad(triangle[i]) - quad(query);
  Quad best = dot(p[0], p[0]);
  for (int i = 0; i < 3; ++i) {
    best = std::min(best, dot(p[i], p[i]));
    const Quad3 edge = p[(i + 1) % 3] - p[i];
    const Quad edge2 = dot(edge, edge);
    if (edge2 == 0) continue;
    const Quad s = -dot(p[i], edge) / edge2;
    if (s <= 0 || s >= 1) continue;
    const Quad3 foot{p[i][0] + s * edge[0], p[i][1] + s * edge[1], p[i][2] + s * edge[2]};
    best = std::min(best, dot(foot, foot));
  }
  const Quad3 u = p[1] - p[0];
  const Quad3 v = p[2] - p[0];
  const Quad3 normal = cross(u, v);
  const Quad normal2 = dot(normal, normal);
  if (normal2 > 0) {
    const Quad s = dot(cross(v, p[0]), normal) / normal2;
    const Quad t = dot(cross(p[0], u), normal) / normal2;
    const Quad height = dot(p[0], normal);
    if (s > 0 && t > 0 && s + t < 1) best = std::min(best, height * height / normal2);
  }
  Quad root = std::sqrt(static_cast<double>(best));
  if (root > 0) root = (root + best / root) / 2;
  return static_cast<double>(root);
}

double reach(const Triangle& triangle, const Vec3& query) {
  return std::max(
      {(triangle[0] - query).norm(), (triangle[1] - query).norm(), (triangle[2] - query).norm()});
}

/// Returns a point near the face, an edge or a corner, a corner itself, or a point anywhere.
Vec3 random_query(const Triangle& t, Random& random) {
  const double near = std::pow(10.0, random.uniform(-12.0, 3.0));
  double a = random.uniform(), b = random.uniform();
  if (a + b > 1.0) {
    a = 1.0 - a;
    b = 1.0 - b;
  }
  const Vec3 inside = t[0] + a * (t[1] - t[0]) + b * (t[2] - t[0]);
  switch (random.below(6)) {
    case 0:
      return inside + near * random.direction();
    case 1:
      return t[random.below(3)] + near * random.direction();
    case 2:
      return t[0] + a * (t[1] - t[0]) + near * random.direction();
    case 3:
      return t[random.below(3)];
    default:
      return 2.0 * random.direction() * random.uniform();
  }
}

TEST(ClosestPoint, DistanceAgreesWithAnIndependentComputationInQuadruplePrecision) {
  Random random(20261120);
  double worst_relative = 0.0;
  for (int i = 0; i < test::trials(1'000'000); ++i) {
    const Triangle triangle = test::hostile_triangle(random);
    const Vec3 query = random_query(triangle, random);
    const double expected = independent_distance(triangle, query);
    const double got = closest_point(triangle, query).distance;
    // Within 1e-12 of the distance. If the query almost touches the triangle, the roundings of the
    // corners' coordinates remain.
    const double allowed = std::max(1e-12 * expected, 2e-15 * reach(triangle, query));
    ASSERT_NEAR(got, expected, allowed) << "pair " << i;
    if (expected > 1e-3 * reach(triangle, query)) {
      worst_relative = std::max(worst_relative, std::abs(got - expected) / expected);
    }
  }
  EXPECT_LT(worst_relative, 1e-12);
}

/// Returns a triangle around a tip at 0, at a distance from 4e-10 to 0.1 of its size. About half of
/// the triangles are needles.
Triangle near_tip(Random& random) {
  Triangle t;
  for (Vec3& corner : t) corner = random.direction() * random.uniform();
  const double thin = std::pow(10.0, random.uniform(-8.0, -2.0));
  if (random.below(2) == 0) t[2] = t[random.below(2)] + thin * random.direction();
  Vec3 at = t[random.below(3)];
  const std::size_t feature = random.below(3);
  if (feature > 0) at += random.uniform() * (t[0] - at);
  if (feature > 1) at += random.uniform() * (t[1] - at);
  const Vec3 side = random.below(2) == 0
                        ? random.direction()
                        : Vec3((t[1] - t[0]).cross(t[2] - t[0])).stableNormalized();
  const Vec3 tip = at + std::pow(10.0, random.uniform(-9.4, -1.0)) * side;
  for (Vec3& corner : t) corner -= tip;
  return t;
}

/// Checks assumption A9 of docs/certified-step.md.
void expect_a9(const Triangle& t) {
  const double size = reach(t, Vec3::Zero());
  const double tau = 2e-10 * size;
  const double kappa = 0.006 * tau;
  const double distance = independent_distance(t, Vec3::Zero());
  if (!(distance >= 3.9 * tau)) return;
  const PreparedTriangle prepared(t, TriangleId(0));
  const double proved = -prepared.at_tip().support;
  ASSERT_GE(prepared.distance(), distance - kappa);
  ASSERT_LE(prepared.distance(), distance + tau / 128.0);
  double longest = 0.0;
  for (int i = 0; i < 3; ++i) longest = std::max(longest, (t[(i + 1) % 3] - t[i]).norm());
  const double height = (t[1] - t[0]).cross(t[2] - t[0]).norm() / longest;
  const bool is_needle = height < 0.01 * longest;
  const bool is_assumed = !is_needle || distance >= 1e-6 * size;
  ASSERT_GE(proved, distance - (is_assumed ? kappa : 2.0 * tau) - 1e-12 * prepared.distance())
      << "needle: " << is_needle << ", distance / size " << distance / size;
}

TEST(PreparedTriangle, DistancesNearTheTipAreAsTheProofAssumes) {
  // The worst triangle that a search found: the normal proves 0.0133 tau less than the distance.
  expect_a9({Vec3(-0x1.251e468024715p-1, -0x1.1f496e2a4161p-1, 0x1.0234b444f1349p-1),
             Vec3(0x1.9772aa3be8f97p-6, 0x1.8f578a807abb7p-6, -0x1.66eb08564746fp-6),
             Vec3(0x1.d29fb74670cfep-6, 0x1.c9a67ebe64fa2p-6, -0x1.9b34a36e320c3p-6)});
  Random random(6);
  for (int i = 0; i < test::trials(1'000'000); ++i) {
    const Triangle triangle = near_tip(random);
    ASSERT_NO_FATAL_FAILURE(expect_a9(triangle)) << "triangle " << i;
  }
}

TEST(ClosestPoint, OffsetIsAPointOfTheTriangleAtTheDistanceGiven) {
  Random random(3);
  for (int i = 0; i < test::trials(100'000); ++i) {
    const Triangle triangle = test::hostile_triangle(random);
    const Vec3 query = random_query(triangle, random);
    const ClosestPoint closest = closest_point(triangle, query);
    const double rounding = 1e-14 * reach(triangle, query);
    ASSERT_NEAR(closest.offset.norm(), closest.distance, rounding);
    ASSERT_LE(independent_distance(triangle, query + closest.offset), rounding);
  }
}

TEST(ClosestPoint, IsTheSameToTheBitInWhateverOrderTheCornersAreGiven) {
  Random random(4);
  constexpr std::array<std::array<int, 3>, 6> orders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  for (int i = 0; i < test::trials(20'000); ++i) {
    const Triangle t = test::hostile_triangle(random);
    const Vec3 query = random_query(t, random);
    const ClosestPoint expected = closest_point(t, query);
    for (const auto& order : orders) {
      const ClosestPoint got = closest_point({t[order[0]], t[order[1]], t[order[2]]}, query);
      ASSERT_EQ(got.offset, expected.offset);
      ASSERT_EQ(got.distance, expected.distance);
    }
  }
}

TEST(ClosestPoint, NeighborsAgreeToTheBitOnAClosestPointOfTheirEdge) {
  Random random(5);
  int on_edge = 0;
  for (int i = 0; i < test::trials(20'000); ++i) {
    const Vec3 a = random.direction(), b = random.direction();
    const Triangle one{a, b, a + 0.5 * random.direction()};
    const Triangle other{b, a, b + 0.5 * random.direction()};
    const Vec3 query = 0.5 * (a + b) + 2.0 * random.direction();
    const ClosestPoint first = closest_point(one, query);
    const ClosestPoint second = closest_point(other, query);
    if (first.feature != Feature::edge_0 || second.feature != Feature::edge_0) continue;
    ++on_edge;
    ASSERT_EQ(first.offset, second.offset);
  }
  EXPECT_GT(on_edge, test::trials(1000));
}

const Triangle right_angle{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};

TEST(ClosestPoint, NamesTheFeatureByTheTrianglesOwnWinding) {
  EXPECT_EQ(closest_point(right_angle, {1, 1, 2}).feature, Feature::face);
  EXPECT_EQ(closest_point(right_angle, {1, -1, 2}).feature, Feature::edge_0);
  EXPECT_EQ(closest_point(right_angle, {3, 3, 2}).feature, Feature::edge_1);
  EXPECT_EQ(closest_point(right_angle, {-1, 1, 2}).feature, Feature::edge_2);
  EXPECT_EQ(closest_point(right_angle, {-1, -1, 2}).feature, Feature::vertex_0);
  EXPECT_EQ(closest_point(right_angle, {9, -1, 2}).feature, Feature::vertex_1);
  EXPECT_EQ(closest_point(right_angle, {-1, 9, 2}).feature, Feature::vertex_2);

  const Triangle rotated{right_angle[2], right_angle[0], right_angle[1]};
  EXPECT_EQ(closest_point(rotated, {1, -1, 2}).feature, Feature::edge_1);
  EXPECT_EQ(closest_point(rotated, {9, -1, 2}).feature, Feature::vertex_2);
  const Triangle flipped{right_angle[0], right_angle[2], right_angle[1]};
  EXPECT_EQ(closest_point(flipped, {1, -1, 2}).feature, Feature::edge_2);
  EXPECT_EQ(closest_point(flipped, {-1, 1, 2}).feature, Feature::edge_0);
}

TEST(ClosestPoint, AQueryOnTheTriangleHasDistanceZero) {
  EXPECT_EQ(closest_point(right_angle, {1, 1, 0}).distance, 0.0);
  EXPECT_EQ(closest_point(right_angle, {2, 0, 0}).distance, 0.0);
  EXPECT_EQ(closest_point(right_angle, {0, 4, 0}).distance, 0.0);
}

TEST(ClosestPoint, AnObtuseCornerDoesNotHideTheNearerSide) {
  // The projection is beyond the long side, but the short side is nearer.
  const Triangle obtuse{Vec3(0, 0, 0), Vec3(10, 0, 0), Vec3(-8, 1, 0)};
  const ClosestPoint closest = closest_point(obtuse, {-6, -1, 0});
  EXPECT_NEAR(closest.distance, independent_distance(obtuse, {-6, -1, 0}), 1e-15);
  EXPECT_EQ(closest.feature, Feature::edge_2);
}

TEST(ClosestPoint, DoesNotLosePrecisionFarFromTheOrigin) {
  const Vec3 far(1e7, -1e7, 1e7);  // exact sums: the corners are small integers
  Triangle moved = right_angle;
  for (Vec3& corner : moved) corner += far;
  const Vec3 query(1, 1, 0.25);
  EXPECT_EQ(closest_point(moved, query + far).distance, closest_point(right_angle, query).distance);
}

}  // namespace
}  // namespace keepout
