// SPDX-License-Identifier: BSD-3-Clause
// Compares the oracle's distance of hull and triangle with a reference that shares no code with it.
// The reference searches all subsets of points of the Minkowski difference for the least norm.
#include "keepout/monitor/hull.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <stdexcept>

#include "keepout/fixtures/random.h"
#include "trials.h"

namespace keepout::oracle {
namespace {

using Real = long double;
using Vector = Eigen::Matrix<Real, 3, 1>;

/// Returns the least norm in the affine hull of up to four points; infinite unless its point is in
/// their convex hull.
Real least_norm(const std::vector<Vector>& points) {
  const auto n = static_cast<Eigen::Index>(points.size()) - 1;
  Eigen::Matrix<Real, 3, Eigen::Dynamic> sides(3, n);
  for (Eigen::Index i = 0; i < n; ++i)
    sides.col(i) = points[static_cast<std::size_t>(i) + 1] - points[0];
  Vector at = points[0];
  if (n > 0) {
    const Eigen::Matrix<Real, Eigen::Dynamic, 1> weights =
        sides.colPivHouseholderQr().solve(Vector(-points[0]));
    if (weights.minCoeff() < -1e-12L || weights.sum() > 1 + 1e-12L) {
      return std::numeric_limits<Real>::infinity();
    }
    at += sides * weights;
  }
  return at.norm();
}

double reference(const std::vector<Vec3>& hull, const Triangle& triangle) {
  std::vector<Vector> all;
  for (const Vec3& p : hull) {
    for (const Vec3& v : triangle) all.push_back(p.cast<Real>() - v.cast<Real>());
  }
  Real least = std::numeric_limits<Real>::infinity();
  std::vector<Vector> chosen;
  const auto visit = [&](const auto& self, std::size_t first) -> void {
    if (!chosen.empty()) least = std::min(least, least_norm(chosen));
    if (chosen.size() == 4) return;
    for (std::size_t i = first; i < all.size(); ++i) {
      chosen.push_back(all[i]);
      self(self, i + 1);
      chosen.pop_back();
    }
  };
  visit(visit, 0);
  return static_cast<double>(least);
}

TEST(Hull, TheDistanceIsThatOfTheReference) {
  Random random(20261124);
  int touching = 0;
  int apart = 0;
  for (int i = 0; i < test::trials(600); ++i) {
    std::vector<Vec3> points;
    const std::size_t count = 1 + random.below(6);
    const double thickness = random.uniform() < 0.3 ? 0.0 : random.uniform();  // flat blades too
    for (std::size_t p = 0; p < count; ++p) {
      points.push_back(random.uniform(0.1, 1.0) * random.direction());
      points.back().z() *= thickness;
    }
    const Vec3 place = random.uniform(0.0, 1.0) * random.direction();
    const double size = std::pow(10.0, random.uniform(-2.0, 1.0));
    Triangle triangle;
    for (Vec3& corner : triangle) corner = place + size * random.direction();
    const Hull hull(points);
    const Bracket found = hull.distance(triangle, narrow_distance);
    const double expected = reference(points, triangle);
    EXPECT_NEAR(found.estimate, expected, 1e-9 * expected + 1e-12) << i;
    EXPECT_LE(found.low, expected * (1 + 1e-9) + 1e-12) << i;
    for (const Vec3& corner : triangle) {
      EXPECT_LE(hull.least_distance(corner), reference(points, {corner, corner, corner}) + 1e-12);
    }
    ++(expected < 1e-12 ? touching : apart);
  }
  EXPECT_GT(touching, test::trials(20));
  EXPECT_GT(apart, test::trials(100));
}

std::vector<Vec3> box() {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
  return corners;
}

TEST(Hull, OfABoxIsWhatItIsByHand) {
  const Hull hull(box());
  const auto distance = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    return hull.distance({a, b, c}, narrow_distance).estimate;
  };
  EXPECT_DOUBLE_EQ(distance({0.5, 0.5, 1.25}, {0.6, 0.5, 2}, {0.5, 0.6, 2}), 0.25);      // face
  EXPECT_DOUBLE_EQ(distance({2, -3, 2}, {2, 4, 2}, {3, 0, 3}), std::sqrt(2.0));          // edge
  EXPECT_DOUBLE_EQ(distance({-1, -1, -1}, {-2, -1, -1}, {-1, -2, -1}), std::sqrt(3.0));  // corner
  EXPECT_DOUBLE_EQ(distance({-5, -5, 1.5}, {5, -5, 1.5}, {0, 9, 1.5}), 0.5);    // over the face
  EXPECT_EQ(distance({-5, -5, 0.5}, {5, -5, 0.5}, {0, 9, 0.5}), 0.0);           // through the hull
  EXPECT_EQ(distance({0.5, 0.5, 0.5}, {0.6, 0.5, 0.5}, {0.5, 0.6, 0.5}), 0.0);  // inside
}

TEST(Hull, HasOneToSixtyFourPoints) {
  EXPECT_THROW(Hull({}), std::invalid_argument);
  std::vector<Vec3> many(64, Vec3(0.5, 0.5, 0.5));
  std::ranges::copy(box(), many.begin());
  const Triangle above{Vec3(0.5, 0.5, 1.25), Vec3(0.6, 0.5, 2), Vec3(0.5, 0.6, 2)};
  EXPECT_DOUBLE_EQ(Hull{many}.distance(above, narrow_distance).estimate, 0.25);
  many.emplace_back(0.5, 0.5, 0.5);
  EXPECT_THROW(Hull{many}, std::invalid_argument);
}

}  // namespace
}  // namespace keepout::oracle
