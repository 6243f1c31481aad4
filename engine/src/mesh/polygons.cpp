// SPDX-License-Identifier: BSD-3-Clause
#include "polygons.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <span>

namespace keepout {
namespace {

using Vec2 = Eigen::Vector2d;

/// The time of ear clipping grows with the third power of the number of corners.
constexpr std::size_t most_ear_corners = 1000;

/// Returns the corners projected along their mean normal (Newell's), so that they run
/// counter-clockwise.
std::vector<Vec2> projected(std::span<const VertexId> polygon, std::span<const Vec3> vertices) {
  const Vec3& origin = vertices[polygon[0]];
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Vec3 one = vertices[polygon[i]] - origin;
    const Vec3 other = vertices[polygon[i + 1]] - origin;
    normal += one.cross(other);
  }
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  std::vector<Vec2> points;
  points.reserve(polygon.size());
  for (const VertexId corner : polygon) {
    const Vec3 from_origin = vertices[corner] - origin;
    const double sideways = normal[axis] < 0.0 ? -from_origin[v] : from_origin[v];
    points.emplace_back(from_origin[u], sideways);
  }
  return points;
}

/// Returns twice the area of a triangle, positive if it runs counter-clockwise.
double doubled_area(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Returns true if the polygon is convex: it never turns right, and it makes only one full turn.
/// One full turn changes the direction along each axis at most twice.
bool is_convex(const std::vector<Vec2>& points) {
  const std::size_t n = points.size();
  int turns[2] = {0, 0};
  double last[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < 2 * n; ++i) {
    const Vec2& a = points[i % n];
    const Vec2& b = points[(i + 1) % n];
    if (doubled_area(a, b, points[(i + 2) % n]) < 0.0) return false;
    for (int axis = 0; axis < 2; ++axis) {
      const double along = b[axis] - a[axis];
      if (along == 0.0) continue;
      if (i >= n && along * last[axis] < 0.0) ++turns[axis];
      last[axis] = along > 0.0 ? 1.0 : -1.0;
    }
  }
  return turns[0] <= 2 && turns[1] <= 2;
}

/// Returns true if the corner at place i of `left` is an ear: convex, without other corners inside.
bool is_ear(const std::vector<Vec2>& points, const std::vector<std::size_t>& left, std::size_t i) {
  const std::size_t n = left.size();
  const Vec2& a = points[left[(i + n - 1) % n]];
  const Vec2& b = points[left[i]];
  const Vec2& c = points[left[(i + 1) % n]];
  if (!(doubled_area(a, b, c) > 0.0)) return false;
  return std::none_of(left.begin(), left.end(), [&](std::size_t other) {
    const Vec2& p = points[other];
    if (p == a || p == b || p == c) return false;
    return doubled_area(a, b, p) >= 0.0 && doubled_area(b, c, p) >= 0.0 &&
           doubled_area(c, a, p) >= 0.0;
  });
}

/// Returns the points, without those that equal the next one.
std::vector<Vec2> without_doubled(const std::vector<Vec2>& points) {
  std::vector<Vec2> distinct;
  distinct.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i] != points[(i + 1) % points.size()]) distinct.push_back(points[i]);
  }
  return distinct;
}

/// Returns the place of a corner that can be cut off: one that equals the next one, or else an ear.
/// Returns left.size() if there is no such corner.
std::size_t place_to_cut(const std::vector<Vec2>& points, const std::vector<std::size_t>& left) {
  const std::size_t n = left.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (points[left[i]] == points[left[(i + 1) % n]]) return i;
  }
  std::size_t i = 0;
  while (i < n && !is_ear(points, left, i)) ++i;
  return i;
}

/// Cuts a polygon. Returns false, and appends no triangle, if the polygon is not convex and has too
/// many corners.
bool cut_polygon(std::span<const VertexId> polygon, std::span<const Vec3> vertices,
                 std::vector<Corners>& triangles) {
  if (polygon.size() == 3) {
    triangles.push_back({polygon[0], polygon[1], polygon[2]});
    return true;
  }
  const std::vector<Vec2> points = projected(polygon, vertices);
  std::vector<std::size_t> left(polygon.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
  // Repeated points must be removed first. With them, is_convex() would compute an area of 0 at a
  // reflex corner, and accept it.
  if (!is_convex(without_doubled(points))) {
    if (polygon.size() > most_ear_corners) return false;
    while (left.size() > 3) {
      const std::size_t i = place_to_cut(points, left);
      if (i == left.size()) break;
      const std::size_t n = left.size();
      triangles.push_back(
          {polygon[left[(i + n - 1) % n]], polygon[left[i]], polygon[left[(i + 1) % n]]});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  for (std::size_t i = 1; i + 1 < left.size(); ++i) {
    triangles.push_back({polygon[left[0]], polygon[left[i]], polygon[left[i + 1]]});
  }
  return true;
}

}  // namespace

void MeshFile::round_to_floats() noexcept {
  for (Vec3& vertex : surface.vertices) vertex = vertex.cast<float>().cast<double>().eval();
}

void Polygons::end_polygon() {
  const std::size_t begin = ends_.empty() ? 0 : ends_.back();
  if (corners_.size() - begin < 3) {
    corners_.resize(begin);
    ++left_out_;
  } else {
    ends_.push_back(corners_.size());
  }
}

void Polygons::cut_into(MeshFile& mesh, const MeshSource& source) const {
  std::vector<Corners>& triangles = mesh.surface.triangles;
  const std::size_t count = triangles.size() + corners_.size() - 2 * ends_.size();
  // A VertexId must be able to number three vertices for each triangle.
  if (count > no_triangle / 3 || mesh.surface.vertices.size() >= no_triangle) {
    source.fail("has too many triangles to read; split or decimate it");
  }
  triangles.reserve(count);
  std::size_t begin = 0;
  for (const std::size_t end : ends_) {
    const auto polygon = std::span(corners_).subspan(begin, end - begin);
    if (!cut_polygon(polygon, mesh.surface.vertices, triangles)) {
      source.fail("a face of " + std::to_string(polygon.size()) +
                  " corners that is not convex; export the mesh as triangles");
    }
    begin = end;
  }
  if (triangles.empty()) {
    source.fail("has no faces, only points or lines; a surface must be made of them first");
  }
  if (left_out_ > 0) {
    mesh.warnings.push_back(std::to_string(left_out_) +
                            " faces with fewer than three corners are left out");
  }
}

}  // namespace keepout
