// SPDX-License-Identifier: BSD-3-Clause
#include "gap.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "keepout/activation/prepared_triangle.h"
#include "keepout/geometry/closest_point.h"
#include "keepout/geometry/nearest_points.h"

namespace keepout {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// The squares of shorter vectors have few digits, so their direction is unknown.
constexpr double least_length2 = 1e-280;

/// Returns the triangle with its corners in lexicographic order, as closest_point_of_ordered()
/// takes them.
Triangle in_order(const Triangle& triangle) noexcept {
  const auto before = [](const Vec3& a, const Vec3& b) {
    const int in_plane = int{a.y() < b.y()} | (int{a.y() == b.y()} & int{a.z() < b.z()});
    return int{a.x() < b.x()} | (int{a.x() == b.x()} & in_plane);
  };
  // Without branches: the place of a corner is the number of corners before it.
  const int one_before_zero = before(triangle[1], triangle[0]);
  const int two_before_zero = before(triangle[2], triangle[0]);
  const int two_before_one = before(triangle[2], triangle[1]);
  Triangle ordered;
  ordered[static_cast<std::size_t>(one_before_zero + two_before_zero)] = triangle[0];
  ordered[static_cast<std::size_t>(1 - one_before_zero + two_before_one)] = triangle[1];
  ordered[static_cast<std::size_t>(2 - two_before_zero - two_before_one)] = triangle[2];
  return ordered;
}

/// The best pair of points found so far, and the directions that may prove its distance.
struct Candidate {
  double distance2 = infinity;
  Vec3 on_core = Vec3::Zero();
  Vec3 away = Vec3::Zero();     // from the triangle to the core
  Vec3 sharper = Vec3::Zero();  // a more accurate direction, from the features; zero if unknown
};

void consider_end(const Vec3& end, const Triangle& ordered, const Vec3& face,
                  Candidate& best) noexcept {
  const ClosestPoint closest = closest_point_of_ordered(ordered, end);
  const double distance2 = closest.distance * closest.distance;
  if (!(distance2 < best.distance2)) return;
  best = {distance2, end, -closest.offset, Vec3::Zero()};
  if (is_face(closest.feature)) best.sharper = face;
}

/// Considers the nearest points of the core's segment and an edge (Ericson, "Real-Time Collision
/// Detection", 2005, 5.1.9). If neither point is an end, the cross product of the two segments is a
/// more accurate direction.
void consider_edge(const Vec3& a, const Vec3& along, double length2, const Vec3& from,
                   const Vec3& to, Candidate& best) noexcept {
  const Vec3 edge = to - from;
  const Vec3 between = a - from;
  const double edge2 = edge.squaredNorm();
  const double lean = along.dot(edge);
  const double at_a = along.dot(between);
  const double at_from = edge.dot(between);
  const double area2 = length2 * edge2 - lean * lean;
  const auto on_core_at = [&](double t) {
    return length2 > 0.0 ? std::clamp((t * lean - at_a) / length2, 0.0, 1.0) : 0.0;
  };
  double u = area2 > 0.0 ? std::clamp((lean * at_from - at_a * edge2) / area2, 0.0, 1.0) : 0.0;
  const double t = edge2 > 0.0 ? std::clamp((lean * u + at_from) / edge2, 0.0, 1.0) : 0.0;
  u = on_core_at(t);  // also if both are nearly parallel, and rounding dominates the first u
  const Vec3 on_core = a + u * along;
  const Vec3 away = on_core - (from + t * edge);
  const double distance2 = away.squaredNorm();
  if (!(distance2 < best.distance2)) return;
  best = {distance2, on_core, away, Vec3::Zero()};
  if (u > 0.0 && u < 1.0 && t > 0.0 && t < 1.0) best.sharper = along.cross(edge);
}

/// Returns true if a segment passes through the interior of a triangle.
bool goes_through(const Vec3& a, const Vec3& b, const Triangle& triangle,
                  const Vec3& face) noexcept {
  const double at_a = face.dot(a - triangle[0]);
  const double at_b = face.dot(b - triangle[0]);
  if (!((at_a > 0.0 && at_b < 0.0) || (at_a < 0.0 && at_b > 0.0))) return false;
  const Vec3 along = b - a;
  // The volumes over the three edges have one sign if the segment passes between them.
  const Vec3 v0 = triangle[0] - a;
  const Vec3 v1 = triangle[1] - a;
  const Vec3 v2 = triangle[2] - a;
  const double s0 = along.dot(v0.cross(v1));
  const double s1 = along.dot(v1.cross(v2));
  const double s2 = along.dot(v2.cross(v0));
  return (s0 >= 0.0 && s1 >= 0.0 && s2 >= 0.0) || (s0 <= 0.0 && s1 <= 0.0 && s2 <= 0.0);
}

/// Returns the gap along that of the two directions which proves the larger distance.
Gap proved(const Candidate& nearest, std::span<const Vec3> core,
           const Triangle& triangle) noexcept {
  Gap best;
  best.contact = nearest.on_core;
  for (const Vec3& towards : {nearest.away, nearest.sharper}) {
    const double length2 = towards.squaredNorm();
    if (!(length2 > least_length2)) continue;
    Vec3 n = towards / std::sqrt(length2);
    if (n.dot(nearest.away) < 0.0) n = -n;
    const double height = height_along(n, core, triangle);
    if (!(height > best.distance)) continue;
    best.distance = height;
    best.normal = n;
  }
  return best;
}

}  // namespace

double height_along(const Vec3& normal, std::span<const Vec3> core,
                    const Triangle& triangle) noexcept {
  double least = infinity;
  for (const Vec3& point : core) least = std::min(least, normal.dot(point));
  return least - support(triangle, normal);
}

Gap gap(std::span<const Vec3> core, const Triangle& triangle) noexcept {
  if (core.size() > 2) {
    const NearestPoints nearest = nearest_points(core, triangle);
    if (nearest.overlap || !(nearest.proven > 0.0)) return {};
    return {nearest.proven, nearest.normal, nearest.on_triangle + nearest.to_core};
  }
  const Vec3& a = core.front();
  const Vec3& b = core.back();
  const Vec3 face = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  const Triangle ordered = in_order(triangle);
  Candidate nearest;
  consider_end(a, ordered, face, nearest);
  if (core.size() == 2) {
    if (goes_through(a, b, triangle, face)) return {};
    consider_end(b, ordered, face, nearest);
    const Vec3 along = b - a;
    const double length2 = along.squaredNorm();
    for (std::size_t e = 0; e < 3; ++e) {
      consider_edge(a, along, length2, triangle[e], triangle[(e + 1) % 3], nearest);
    }
  }
  Gap best = proved(nearest, core, triangle);
  // If rounding dominates the features' directions, the search may find a better one.
  const double distance = std::sqrt(nearest.distance2);
  if (best.distance < distance * (1.0 - 1e-11)) {
    const NearestPoints searched = nearest_points(core, triangle);
    if (!searched.overlap && searched.proven > best.distance) {
      best.distance = searched.proven;
      best.normal = searched.normal;
    }
  }
  return best;
}

}  // namespace keepout
