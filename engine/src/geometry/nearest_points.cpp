// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/nearest_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>

#include "direction_of.h"
#include "keepout/geometry/closest_point.h"
#include "keepout/geometry/orientation.h"

namespace keepout {
namespace {

/// A corner of the Minkowski difference core - triangle. The search finds the point of this
/// difference that is nearest to the origin.
struct Vertex {
  Vec3 at;
  const Vec3* point;
  const Vec3* corner;

  bool operator==(const Vertex& o) const noexcept { return point == o.point && corner == o.corner; }
};

/// Up to four vertices.
struct Simplex {
  std::array<Vertex, 4> vertices;
  int size = 0;

  void add(const Vertex& v) noexcept { vertices[size++] = v; }
  bool holds(const Vertex& v) const noexcept {
    return std::find(vertices.begin(), vertices.begin() + size, v) != vertices.begin() + size;
  }
};

/// A simplex that has its nearest point to the origin in its interior.
struct Nearest {
  Simplex simplex;
  Vec3 at;
  double distance;
};

class Difference {
 public:
  Difference(std::span<const Vec3> points, const Triangle& triangle) noexcept
      : points_(points), triangle_(triangle) {}

  Vertex vertex(const Vec3& point, const Vec3& corner) const noexcept {
    return {point - corner, &point, &corner};
  }

  /// Returns the vertex that is least far along n.
  Vertex lowest(const Vec3& n) const noexcept {
    const auto less = [&](const Vec3& a, const Vec3& b) { return n.dot(a) < n.dot(b); };
    return vertex(*std::min_element(points_.begin(), points_.end(), less),
                  *std::max_element(triangle_.begin(), triangle_.end(), less));
  }

  /// Returns the start of the search: the triangle's point nearest to the first point. For a core
  /// of one point this is the result, bitwise identical to that of closest_point.
  Nearest first() const noexcept {
    const Vec3& point = points_.front();
    const ClosestPoint closest = closest_point(triangle_, point);
    Nearest nearest{{}, -closest.offset, closest.distance};
    for (int i = 0; i < 3; ++i) {
      if (on_feature(closest.feature, i)) nearest.simplex.add(vertex(point, triangle_[i]));
    }
    return nearest;
  }

  /// Returns the nearest point of three vertices, some of which may be equal.
  static Nearest of(const Vertex& a, const Vertex& b, const Vertex& c) noexcept {
    const ClosestPoint closest = closest_point({a.at, b.at, c.at}, Vec3::Zero());
    Nearest nearest{{}, closest.offset, closest.distance};
    const std::array<const Vertex*, 3> vertices{&a, &b, &c};
    for (int i = 0; i < 3; ++i) {
      if (on_feature(closest.feature, i)) nearest.simplex.add(*vertices[i]);
    }
    return nearest;
  }

 private:
  static bool on_feature(Feature feature, int corner) noexcept {
    if (is_face(feature)) return true;
    const int number = number_of(feature);
    if (is_vertex(feature)) return corner == number;
    return corner == number || corner == (number + 1) % 3;
  }

  std::span<const Vec3> points_;
  const Triangle& triangle_;
};

/// Returns true if the origin is inside a tetrahedron, decided exactly.
bool holds_origin(const Simplex& s) noexcept {
  const auto& v = s.vertices;
  const Vec3 origin = Vec3::Zero();
  constexpr int faces[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
  for (const auto& f : faces) {
    const int apex = side_of_plane(v[f[0]].at, v[f[1]].at, v[f[2]].at, v[f[3]].at);
    const int here = side_of_plane(v[f[0]].at, v[f[1]].at, v[f[2]].at, origin);
    if (apex == 0 || apex != here) return false;
  }
  return true;
}

/// Returns the nearest point after a vertex has joined a simplex. Only sides with the new vertex
/// can be nearer.
Nearest joined(const Simplex& old, const Vertex& added) noexcept {
  const auto& v = old.vertices;
  if (old.size == 1) return Difference::of(v[0], added, added);
  if (old.size == 2) return Difference::of(v[0], v[1], added);
  Nearest best = Difference::of(v[0], v[1], added);
  for (const Nearest& other :
       {Difference::of(v[1], v[2], added), Difference::of(v[0], v[2], added)}) {
    if (other.distance < best.distance) best = other;
  }
  return best;
}

/// Returns the nearest point of the triangle. Its corners have the same convex weights as the
/// vertices of the simplex.
Vec3 on_triangle(const Nearest& nearest) noexcept {
  const auto& v = nearest.simplex.vertices;
  if (nearest.simplex.size == 1) return *v[0].corner;
  const Vec3 from_first = nearest.at - v[0].at;
  const Vec3 a = v[1].at - v[0].at;
  if (nearest.simplex.size == 2) {
    const double share = std::clamp(from_first.dot(a) / a.squaredNorm(), 0.0, 1.0);
    return *v[0].corner + share * (*v[1].corner - *v[0].corner);
  }
  const Vec3 b = v[2].at - v[0].at;
  const Vec3 n = a.cross(b);
  const double n2 = n.squaredNorm();
  const double of_a = std::clamp(n.dot(from_first.cross(b)) / n2, 0.0, 1.0);
  const double of_b = std::clamp(n.dot(a.cross(from_first)) / n2, 0.0, 1.0 - of_a);
  return *v[0].corner + of_a * (*v[1].corner - *v[0].corner) + of_b * (*v[2].corner - *v[0].corner);
}

/// Returns the normal from the simplex, because near the origin the nearest point is mostly
/// rounding.
Vec3 sharpened(const Nearest& nearest) noexcept {
  const auto& v = nearest.simplex.vertices;
  if (nearest.simplex.size == 3) {
    const Vec3 n = unit_normal({v[0].at, v[1].at, v[2].at});
    return n.dot(nearest.at) < 0.0 ? Vec3(-n) : n;
  }
  Vec3 n = nearest.at;
  if (nearest.simplex.size == 2) {
    const Vec3 edge = direction_of(v[1].at - v[0].at);
    for (int i = 0; i < 2; ++i) n -= n.dot(edge) * edge;
  }
  return direction_of(n);
}

}  // namespace

NearestPoints nearest_points(std::span<const Vec3> points, const Triangle& triangle) noexcept {
  const Difference difference(points, triangle);
  Nearest nearest = difference.first();
  bool overlap = !(nearest.distance > 0.0);
  // About ten rounds are usual. An error of the point along the surface, by the root of a rounding,
  // hardly changes the distance. But it changes the plane that proves the distance, so a few rounds
  // without progress are allowed.
  constexpr int most_rounds = 256;
  constexpr double rounding = 1e-15;
  int rounds_to_settle = 8;
  for (int round = 0; round < most_rounds && points.size() > 1 && !overlap; ++round) {
    const Vertex added = difference.lowest(nearest.at);
    const double unproven = nearest.distance - nearest.at.dot(added.at) / nearest.distance;
    if (nearest.simplex.holds(added) || unproven <= rounding * added.at.norm()) break;
    if (nearest.simplex.size == 3) {
      Simplex tetrahedron = nearest.simplex;
      tetrahedron.add(added);
      overlap = holds_origin(tetrahedron);
      if (overlap) break;
    }
    const Nearest next = joined(nearest.simplex, added);
    if (!(next.distance < nearest.distance) && --rounds_to_settle < 0) break;
    if (!(next.distance <= nearest.distance * (1.0 + rounding))) break;
    nearest = next;
    overlap = !(nearest.distance > 0.0);
  }
  NearestPoints result{on_triangle(nearest), nearest.at,
                       nearest.distance,     overlap,
                       Vec3::Zero(),         -std::numeric_limits<double>::infinity()};
  if (overlap) return result;
  for (const Vec3& n : {sharpened(nearest), direction_of(nearest.at)}) {
    if (!(n.squaredNorm() > 0.5)) continue;  // a simplex without an area has no normal
    const double proven = difference.lowest(n).at.dot(n);
    if (!(proven > result.proven)) continue;
    result.normal = n;
    result.proven = proven;
  }
  return result;
}

}  // namespace keepout
