// SPDX-License-Identifier: BSD-3-Clause
#include "free_polytope_triangle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "../../geometry/corner_order.h"

namespace keepout {
namespace {

// A height below this fraction of the longest side is rounding, as for the closest-point kernel.
constexpr double needle = 1e-14;
// A slope below this is rounding.
constexpr double level = 1e-14;
constexpr double nothing = -std::numeric_limits<double>::infinity();

/// Returns the unit normal, from the longest side and the height on it, orthogonalized twice. So
/// even for a needle all corners are in its plane, up to their own rounding.
Vec3 normal_of(const std::array<Vec3, 3>& p) noexcept {
  int start = 0;
  double longest2 = -1.0;
  for (int i = 0; i < 3; ++i) {
    const double length2 = (p[(i + 1) % 3] - p[i]).squaredNorm();
    if (length2 > longest2) {
      start = i;
      longest2 = length2;
    }
  }
  if (!(longest2 > 0.0)) return Vec3::Zero();
  const Vec3 base = (p[(start + 1) % 3] - p[start]) / std::sqrt(longest2);
  Vec3 height = p[(start + 2) % 3] - p[start];
  height -= height.dot(base) * base;
  height -= height.dot(base) * base;
  const double length = height.norm();
  if (!(length > needle * std::sqrt(longest2))) return Vec3::Zero();
  return base.cross(height / length);
}

/// Like support_within(), but for the part of one side that is in the ball.
double support_of_side(const Vec3& a, const Vec3& b, const Vec3& normal, double radius) noexcept {
  const Vec3 side = b - a;
  const double length = side.norm();
  if (!(length > 0.0)) return a.norm() <= radius ? normal.dot(a) : nothing;
  const Vec3 along = side / length;
  const double middle = -a.dot(along);
  const double half2 = radius * radius - (a + middle * along).squaredNorm();
  if (!(half2 >= 0.0)) return nothing;
  const double half = std::sqrt(half2);
  const double from = std::max(0.0, middle - half);
  const double to = std::min(length, middle + half);
  if (from > to) return nothing;
  return std::max(normal.dot(a + from * along), normal.dot(a + to * along));
}

bool is_inside(const TriangleFromTip& triangle, const Vec3& in_plane, double slack) noexcept {
  const auto& p = triangle.corners;
  const Vec3 area = (p[1] - p[0]).cross(p[2] - p[0]);
  const double turn = area.dot(triangle.normal) < 0.0 ? -1.0 : 1.0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 side = p[(i + 1) % 3] - p[i];
    const double length = side.norm();
    if (turn * triangle.normal.cross(side).dot(in_plane - p[i]) < -slack * length) return false;
  }
  return true;
}

/// Like support_within(), but for the disc in which the ball cuts the triangle's plane, if the
/// largest value is inside the triangle. Otherwise the largest value is on a side.
double support_of_disc(const TriangleFromTip& triangle, const Vec3& normal, double radius,
                       double slack) noexcept {
  const Vec3 foot = triangle.normal * triangle.normal.dot(triangle.corners[0]);
  const double rim2 = radius * radius - foot.squaredNorm();
  if (!(rim2 >= 0.0)) return nothing;
  const double rim = std::sqrt(rim2);
  Vec3 slope = normal - triangle.normal * triangle.normal.dot(normal);
  slope -= triangle.normal * triangle.normal.dot(slope);
  const double steepness = slope.norm();
  // Seen along its normal the disc is level, and the rest of the slope has any direction. If the
  // center of the disc is outside the triangle, a side of the triangle crosses the disc, or all of
  // the disc is outside.
  const Vec3 extreme = steepness > level ? Vec3(foot + slope * (rim / steepness)) : foot;
  if (!is_inside(triangle, extreme, slack)) return nothing;
  return normal.dot(foot) + rim * steepness;
}

}  // namespace

TriangleFromTip triangle_from_tip(const Triangle& triangle, const Vec3& tip) noexcept {
  const CornerOrder order = corner_order(triangle);
  TriangleFromTip seen;
  for (int i = 0; i < 3; ++i) seen.corners[i] = triangle[order.corner[i]] - tip;
  seen.normal = normal_of(seen.corners);
  return seen;
}

double support_within(const TriangleFromTip& triangle, const Vec3& normal, double radius,
                      double slack) noexcept {
  const auto& p = triangle.corners;
  const double whole = std::max({normal.dot(p[0]), normal.dot(p[1]), normal.dot(p[2])});
  const double farthest2 = std::max({p[0].squaredNorm(), p[1].squaredNorm(), p[2].squaredNorm()});
  if (farthest2 <= radius * radius || triangle.normal.isZero(0.0)) return whole;

  // The ball of the sides is the larger one. If rounding moves the extreme point of the disc out of
  // the triangle, the side that it crosses still gives the support.
  double support = support_of_disc(triangle, normal, radius + 0.5 * slack, slack);
  for (int i = 0; i < 3; ++i) {
    support = std::max(support, support_of_side(p[i], p[(i + 1) % 3], normal, radius + slack));
  }
  return std::min(support, whole);
}

}  // namespace keepout
