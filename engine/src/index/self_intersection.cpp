// SPDX-License-Identifier: BSD-3-Clause

#include "keepout/index/self_intersection.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "../mesh/fault_list.h"
#include "keepout/geometry/orientation.h"
#include "keepout/geometry/shapes.h"

namespace keepout {
namespace {

using Sides = std::array<int, 3>;

constexpr int next(int corner) noexcept { return (corner + 1) % 3; }

Sides sides_of(const Triangle& plane, const Triangle& points) noexcept {
  return {side_of_plane(plane[0], plane[1], plane[2], points[0]),
          side_of_plane(plane[0], plane[1], plane[2], points[1]),
          side_of_plane(plane[0], plane[1], plane[2], points[2])};
}

bool all_apart(const Sides& s) noexcept { return s[0] != 0 && s[0] == s[1] && s[1] == s[2]; }
bool all_on(const Sides& s) noexcept { return s[0] == 0 && s[1] == 0 && s[2] == 0; }

/// Returns true if all the points are strictly outside one side of the flat triangle.
template <std::size_t N>
bool side_separates(const Triangle& triangle, const std::array<Vec3, N>& points,
                    int axis) noexcept {
  const int inside = turn(triangle[0], triangle[1], triangle[2], axis);
  for (int e = 0; e < 3; ++e) {
    if (std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
          return turn(triangle[e], triangle[next(e)], p, axis) == -inside;
        })) {
      return true;
    }
  }
  return false;
}

// In a plane, two convex shapes that are apart are separated by a line along a side of one of them.

bool overlap_in_plane(const Triangle& one, const Triangle& other) noexcept {
  const int axis = axis_of_sight(one);
  return !side_separates(one, other, axis) && !side_separates(other, one, axis);
}

bool overlap_in_plane(const Vec3& p, const Vec3& q, const Triangle& triangle) noexcept {
  const int axis = axis_of_sight(triangle);
  if (side_separates(triangle, std::array{p, q}, axis)) return false;
  const Sides beside{turn(p, q, triangle[0], axis), turn(p, q, triangle[1], axis),
                     turn(p, q, triangle[2], axis)};
  return !all_apart(beside);
}

/// Returns true if the segment touches the triangle. `side_p`, `side_q`: the sides of its ends
/// relative to the triangle's plane.
bool touches(const Vec3& p, int side_p, const Vec3& q, int side_q,
             const Triangle& triangle) noexcept {
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) return overlap_in_plane(p, q, triangle);
  // The line through p and q crosses the plane once: inside, if it passes all sides in the same
  // direction.
  int seen = 0;
  for (int e = 0; e < 3; ++e) {
    const int way = side_of_plane(p, q, triangle[e], triangle[next(e)]);
    if (way * seen < 0) return false;
    if (way != 0) seen = way;
  }
  return true;
}

bool any_edge_touches(const Triangle& edges, const Sides& sides,
                      const Triangle& triangle) noexcept {
  for (int e = 0; e < 3; ++e) {
    if (touches(edges[e], sides[e], edges[next(e)], sides[next(e)], triangle)) return true;
  }
  return false;
}

/// The corners that two triangles have in common.
struct Shared {
  int count = 0;
  std::array<bool, 3> of_one{}, of_other{};
};

Shared shared_corners(const Corners& one, const Corners& other) noexcept {
  Shared shared;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (one[i] != other[j]) continue;
      ++shared.count;
      shared.of_one[i] = true;
      shared.of_other[j] = true;
    }
  }
  return shared;
}

int only(const std::array<bool, 3>& corners, bool wanted) noexcept {
  return static_cast<int>(std::find(corners.begin(), corners.end(), wanted) - corners.begin());
}

bool meet_apart(const Triangle& one, const Triangle& other) noexcept {
  const Sides other_by_one = sides_of(one, other);
  if (all_apart(other_by_one)) return false;
  if (all_on(other_by_one)) return overlap_in_plane(one, other);
  const Sides one_by_other = sides_of(other, one);
  if (all_apart(one_by_other)) return false;
  return any_edge_touches(other, other_by_one, one) || any_edge_touches(one, one_by_other, other);
}

/// For triangles with one common corner. From that corner, the ray to a second common point leaves
/// the first triangle through the side opposite the corner.
bool meet_beyond_corner(const Triangle& one, int corner_one, const Triangle& other,
                        int corner_other) noexcept {
  const auto opposite_touches = [](const Triangle& from, int corner, const Triangle& to) {
    const Vec3& p = from[next(corner)];
    const Vec3& q = from[next(next(corner))];
    return touches(p, side_of_plane(to[0], to[1], to[2], p), q,
                   side_of_plane(to[0], to[1], to[2], q), to);
  };
  return opposite_touches(one, corner_one, other) || opposite_touches(other, corner_other, one);
}

/// For triangles with a common edge: they share more only if they are coplanar and on the same side
/// of it.
bool meet_beyond_edge(const Triangle& one, int apex_one, const Triangle& other,
                      int apex_other) noexcept {
  if (side_of_plane(one[0], one[1], one[2], other[apex_other]) != 0) return false;
  const int axis = axis_of_sight(one);
  const Vec3& a = one[next(apex_one)];
  const Vec3& b = one[next(next(apex_one))];
  return turn(a, b, one[apex_one], axis) == turn(a, b, other[apex_other], axis);
}

/// Like meet_improperly(), for triangles that have an area.
bool meet(const Mesh& mesh, TriangleId one, TriangleId other) noexcept {
  const Shared shared = shared_corners(mesh.corners(one), mesh.corners(other));
  const Triangle a = mesh.triangle(one);
  const Triangle b = mesh.triangle(other);
  switch (shared.count) {
    case 0:
      return meet_apart(a, b);
    case 1:
      return meet_beyond_corner(a, only(shared.of_one, true), b, only(shared.of_other, true));
    case 2:
      return meet_beyond_edge(a, only(shared.of_one, false), b, only(shared.of_other, false));
    default:
      return true;
  }
}

/// Returns the point between p and q whose distances from them have the ratio `from` to `to`; the
/// middle if both are zero.
Vec3 between(const Vec3& p, double from, const Vec3& q, double to) noexcept {
  return from + to > 0.0 ? Vec3(p + from / (from + to) * (q - p)) : Vec3(0.5 * (p + q));
}

/// Adds to `sum` the points in which edges of one triangle pierce the other. Returns their number.
int add_piercings(const Triangle& edges, const Triangle& triangle, Vec3& sum) noexcept {
  const Vec3 normal = unit_normal(triangle);
  const Sides sides = sides_of(triangle, edges);
  int count = 0;
  for (int e = 0; e < 3; ++e) {
    const Vec3& p = edges[e];
    const Vec3& q = edges[next(e)];
    if (sides[e] * sides[next(e)] >= 0 || !touches(p, sides[e], q, sides[next(e)], triangle)) {
      continue;
    }
    const double from = std::abs(normal.dot(p - triangle[0]));
    const double to = std::abs(normal.dot(q - triangle[0]));
    sum += between(p, from, q, to);
    ++count;
  }
  return count;
}

/// Adds to `sum` the corners that are on the other triangle. Returns their number.
int add_corners_on(const Triangle& corners, const Triangle& triangle, Vec3& sum) noexcept {
  const Sides sides = sides_of(triangle, corners);
  int count = 0;
  for (int c = 0; c < 3; ++c) {
    if (sides[c] != 0 || !overlap_in_plane(corners[c], corners[c], triangle)) continue;
    sum += corners[c];
    ++count;
  }
  return count;
}

/// Adds to `sum` the points in which edges of two coplanar triangles cross. Returns their number.
int add_crossings(const Triangle& one, const Triangle& other, Vec3& sum) noexcept {
  if (!all_on(sides_of(one, other))) return 0;
  const int axis = axis_of_sight(one);
  int count = 0;
  for (int e = 0; e < 3; ++e) {
    const Vec3& p = one[e];
    const Vec3& q = one[next(e)];
    for (int f = 0; f < 3; ++f) {
      const Vec3& r = other[f];
      const Vec3& s = other[next(f)];
      if (turn(p, q, r, axis) * turn(p, q, s, axis) >= 0) continue;
      if (turn(r, s, p, axis) * turn(r, s, q, axis) >= 0) continue;
      const Vec3 along = s - r;
      sum += between(p, along.cross(p - r).norm(), q, along.cross(q - r).norm());
      ++count;
    }
  }
  return count;
}

Box box_of(const Triangle& t) noexcept {
  return {t[0].cwiseMin(t[1]).cwiseMin(t[2]), t[0].cwiseMax(t[1]).cwiseMax(t[2])};
}

bool overlap(const Box& one, const Box& other) noexcept {
  return (one.low.array() <= other.high.array()).all() &&
         (other.low.array() <= one.high.array()).all();
}

/// Returns a point that two triangles have in common: the middle of the points where edges of one
/// pierce the other. Without such points, as in one plane, it is the middle of corners on the other
/// triangle and of crossings of edges. The common part of two triangles is convex, so the middle is
/// in it.
Vec3 meeting_point(const Triangle& one, const Triangle& other) noexcept {
  Vec3 sum = Vec3::Zero();
  int count = add_piercings(one, other, sum) + add_piercings(other, one, sum);
  if (count == 0) {
    count = add_corners_on(one, other, sum) + add_corners_on(other, one, sum) +
            add_crossings(one, other, sum);
  }
  const Box a = box_of(one);
  const Box b = box_of(other);
  // Rounding may lead astray, or leave no point, where they are nearly in one plane or lengths are
  // near the end of a double's range.
  const Vec3 middle = sum / std::max(1, count);
  return middle.cwiseMax(a.low.cwiseMax(b.low)).cwiseMin(a.high.cwiseMin(b.high));
}

/// Returns a ball that contains the triangle, enlarged by the rounding of this computation.
Ball ball_around(const Triangle& t, const Box& box) noexcept {
  const Vec3 center = box.center();
  double radius = 0.0;
  for (const Vec3& corner : t) radius = std::max(radius, (corner - center).norm());
  return {center, radius + 1e-12 * (radius + center.cwiseAbs().maxCoeff())};
}

}  // namespace

bool meet_improperly(const Mesh& mesh, TriangleId one, TriangleId other) noexcept {
  return axis_of_sight(mesh.triangle(one)) >= 0 && axis_of_sight(mesh.triangle(other)) >= 0 &&
         meet(mesh, one, other);
}

SelfIntersections find_self_intersections(const Mesh& mesh, const SpatialIndex& index,
                                          std::size_t most_places,
                                          const std::function<void()>& examined) {
  const auto count = static_cast<TriangleId>(mesh.triangle_count());
  std::vector<Box> boxes(count);
  std::vector<bool> flat(count);  // without an area
  for (TriangleId t = 0; t < count; ++t) {
    boxes[t] = box_of(mesh.triangle(t));
    flat[t] = axis_of_sight(mesh.triangle(t)) < 0;
  }

  FaultList pairs(6);
  TriangleBuffer nearby(count);
  const auto add_pairs_of = [&](TriangleId t) {
    nearby.clear();
    index.collect(ball_around(mesh.triangle(t), boxes[t]), nearby);
    for (const TriangleId other : nearby) {
      if (other > t && !flat[other] && overlap(boxes[t], boxes[other]) && meet(mesh, t, other)) {
        const Corners& a = mesh.corners(t);
        const Corners& b = mesh.corners(other);
        pairs.add({a[0], a[1], a[2], b[0], b[1], b[2]});
      }
    }
  };
  for (TriangleId t = 0; t < count; ++t) {
    if (!flat[t]) add_pairs_of(t);
    if (examined) examined();
  }
  SelfIntersections found{pairs.size(), pairs.places(mesh, most_places)};
  for (FaultPlace& place : found.places.places) {
    const std::vector<Vec3>& c = place.corners;
    place.at = meeting_point({c[0], c[1], c[2]}, {c[3], c[4], c[5]});
  }
  return found;
}

std::size_t count_self_intersections(const Mesh& mesh, const SpatialIndex& index) {
  return find_self_intersections(mesh, index, 0).pairs;
}

}  // namespace keepout
