// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/lean_test.h"

#include <Eigen/Geometry>
#include <cmath>

#include "keepout/geometry/closest_point.h"

namespace keepout::app {
namespace {

/// The triangle's point nearest to p, region by region of its plane.
Vec3 nearest_point(const Triangle& triangle, const Vec3& p) noexcept {
  const Vec3 &a = triangle[0], &b = triangle[1], &c = triangle[2];
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return a;
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return a + d1 / (d1 - d3) * ab;
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  }
  const double share = 1.0 / (va + vb + vc);
  return a + vb * share * ab + vc * share * ac;
}

}  // namespace

bool touches_ball(const Triangle& triangle, const Vec3& center, double radius) noexcept {
  const double squared = (nearest_point(triangle, center) - center).squaredNorm();
  const double limit = radius * radius;
  constexpr double doubt = 1e-6;  // of the limit: far more than rounding, but for needles
  if (std::abs(squared - limit) > doubt * limit) return squared <= limit;
  return closest_point(triangle, center).distance <= radius;  // NaN comes here as well
}

}  // namespace keepout::app
