// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/closest_point.h"

#include <cmath>

#include "corner_order.h"

namespace keepout {
namespace {

// A height below this share of the longest side is rounding: such a triangle is its longest edge.
constexpr double needle = 1e-14;

/// Where on the segment from a to b the origin's nearest point lies.
struct OnSegment {
  Vec3 point;
  int end;  // 0: at a, 1: at b, -1: in between
};

OnSegment closest_on_segment(const Vec3& a, const Vec3& b) noexcept {
  const Vec3 along = b - a;
  const double from_a = -a.dot(along);
  const double from_b = b.dot(along);
  if (!(from_a > 0.0)) return {a, 0};
  if (!(from_b > 0.0)) return {b, 1};
  // Measured from the nearer end, where the rounding of the parameter matters least.
  const double length2 = along.squaredNorm();
  if (from_a <= from_b) return {a + along * (from_a / length2), -1};
  return {b - along * (from_b / length2), -1};
}

/// The origin's projection on the plane of a triangle, if it falls inside. The plane's frame is the
/// longest side and the height upon it, orthogonalised twice, so that even needles lose no digits.
bool project_inside(const Vec3& a, const Vec3& b, const Vec3& apex, Vec3& projection) noexcept {
  const Vec3 base = b - a;
  const double base2 = base.squaredNorm();
  const Vec3 side = apex - a;
  const double foot = side.dot(base) / base2;
  Vec3 height = side - foot * base;
  height -= (height.dot(base) / base2) * base;
  const double height2 = height.squaredNorm();
  if (!(height2 > needle * needle * base2)) return false;

  const double along = -a.dot(base) / base2;
  const double up = -a.dot(height) / height2;  // barycentric coordinate of the apex
  const double at_b = along - up * foot;
  if (!(up > 0.0 && at_b > 0.0 && up + at_b < 1.0)) return false;
  projection = a + along * base + up * height;
  return true;
}

/// Edge between two corners, by the numbers of the triangle's own winding.
constexpr Feature edge_between(int i, int j) noexcept {
  const int opposite = 3 - i - j;
  return static_cast<Feature>(static_cast<int>(Feature::edge_0) + (opposite + 1) % 3);
}

constexpr Feature vertex_feature(int i) noexcept {
  return static_cast<Feature>(static_cast<int>(Feature::vertex_0) + i);
}

}  // namespace

ClosestPoint closest_point(const Triangle& triangle, const Vec3& query) noexcept {
  const CornerOrder order = corner_order(triangle);
  std::array<Vec3, 3> p;
  for (int i = 0; i < 3; ++i) p[i] = triangle[order.corner[i]] - query;

  constexpr std::array<std::array<int, 2>, 3> sides{{{0, 1}, {1, 2}, {0, 2}}};
  int longest = 0;
  double longest2 = -1.0;
  for (int s = 0; s < 3; ++s) {
    const double length2 = (p[sides[s][1]] - p[sides[s][0]]).squaredNorm();
    if (length2 > longest2) {
      longest = s;
      longest2 = length2;
    }
  }
  const int base_a = sides[longest][0];
  const int base_b = sides[longest][1];
  Vec3 projection;
  if (project_inside(p[base_a], p[base_b], p[3 - base_a - base_b], projection)) {
    return {projection, projection.norm(), Feature::face};
  }

  // Not inside: the nearest point of the nearest side. All three are tried, since at an obtuse
  // corner the side that the projection lies beyond need not be the nearest one.
  ClosestPoint best{Vec3::Zero(), 0.0, Feature::vertex_0};
  double best2 = -1.0;
  for (const auto& side : sides) {
    const OnSegment on = closest_on_segment(p[side[0]], p[side[1]]);
    const double distance2 = on.point.squaredNorm();
    if (best2 >= 0.0 && !(distance2 < best2)) continue;
    best2 = distance2;
    best.offset = on.point;
    const int i = order.corner[side[0]];
    const int j = order.corner[side[1]];
    best.feature = on.end < 0 ? edge_between(i, j) : vertex_feature(on.end == 0 ? i : j);
  }
  best.distance = std::sqrt(best2);
  return best;
}

}  // namespace keepout
