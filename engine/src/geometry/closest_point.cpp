// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/closest_point.h"

#include <cmath>

#include "closest_on_segment.h"
#include "corner_order.h"

namespace keepout {
namespace {

// A height below this fraction of the longest side is rounding: the triangle counts as its longest
// edge.
constexpr double no_height = 1e-14;

/// Projects the origin on the plane of a triangle. Returns true if the projection is inside. The
/// plane's frame is the longest side and the height on it, orthogonalized twice, so that even
/// needles lose no digits.
bool project_inside(const Vec3& a, const Vec3& b, const Vec3& apex, Vec3& projection) noexcept {
  const Vec3 base = b - a;
  const double base2 = base.squaredNorm();
  const double per_base2 = 1.0 / base2;
  const Vec3 side = apex - a;
  const double foot = side.dot(base) * per_base2;
  Vec3 height = side - foot * base;
  height -= (height.dot(base) * per_base2) * base;
  const double height2 = height.squaredNorm();
  if (!(height2 > no_height * no_height * base2)) return false;

  const double along = -a.dot(base) * per_base2;
  const double up = -a.dot(height) / height2;  // barycentric coordinate of the apex
  const double at_b = along - up * foot;
  if (!(up > 0.0 && at_b > 0.0 && up + at_b < 1.0)) return false;
  projection = a + along * base + up * height;
  return true;
}

/// Returns the edge between two corners, by the numbers of the triangle's own winding.
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
  Triangle ordered;
  for (int i = 0; i < 3; ++i) ordered[i] = triangle[order.corner[i]];
  ClosestPoint closest = closest_point_of_ordered(ordered, query);
  if (is_edge(closest.feature)) {
    const int from = number_of(closest.feature);
    closest.feature = edge_between(order.corner[from], order.corner[(from + 1) % 3]);
  } else if (is_vertex(closest.feature)) {
    closest.feature = vertex_feature(order.corner[number_of(closest.feature)]);
  }
  return closest;
}

ClosestPoint closest_point_of_ordered(const Triangle& triangle, const Vec3& query) noexcept {
  const std::array<Vec3, 3> p{triangle[0] - query, triangle[1] - query, triangle[2] - query};
  for (int corner = 0; corner < 3; ++corner) {
    const Vec3& here = p[corner];
    // Beyond both sides that meet there. True for NaN, which a side of length zero gives.
    const auto is_beyond = [&](const Vec3& other) { return !(-here.dot(other - here) > 0.0); };
    if (is_beyond(p[(corner + 1) % 3]) && is_beyond(p[(corner + 2) % 3])) {
      return {here, here.norm(), vertex_feature(corner)};
    }
  }

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

  // The projection is not inside, so the nearest side has the nearest point. All three sides are
  // tried: at an obtuse corner the projection can be beyond a side that is not the nearest.
  ClosestPoint best{Vec3::Zero(), 0.0, Feature::vertex_0};
  double best2 = -1.0;
  for (const auto& side : sides) {
    const OnSegment on = closest_on_segment(p[side[0]], p[side[1]]);
    const double distance2 = on.point.squaredNorm();
    if (best2 >= 0.0 && !(distance2 < best2)) continue;
    best2 = distance2;
    best.offset = on.point;
    best.feature = on.end < 0 ? edge_between(side[0], side[1])
                              : vertex_feature(on.end == 0 ? side[0] : side[1]);
  }
  best.distance = std::sqrt(best2);
  return best;
}

}  // namespace keepout
