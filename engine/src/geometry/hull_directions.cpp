// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "hull_directions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>

namespace keepout {
namespace {

// Corners whose height is below this share of their longest side are on a line to within rounding:
// no normal can be told from them.
constexpr double needle = 1e-14;

// Some roundings of a unit vector: such directions are the same.
constexpr double same_direction = 1e-15;

void add_once(std::vector<Vec3>& directions, const Vec3& n) {
  const bool known = std::any_of(directions.begin(), directions.end(), [&](const Vec3& d) {
    return (d - n).norm() <= same_direction || (d + n).norm() <= same_direction;
  });
  if (!known) directions.push_back(n);
}

/// Whether points lie on both sides of a plane, clearly: what is within rounding of the plane, and
/// of the normal's own error, counts for neither.
bool cuts(std::span<const Vec3> points, const Vec3& on_plane, const Vec3& n, double error) {
  bool above = false, below = false;
  for (const Vec3& p : points) {
    const Vec3 offset = p - on_plane;
    const double height = n.dot(offset);
    const double slack = error * offset.norm();
    above = above || height > slack;
    below = below || height < -slack;
  }
  return above && below;
}

}  // namespace

HullDirections hull_directions(std::span<const Vec3> points) {
  const std::size_t count = points.size();
  HullDirections directions;
  // Each edge of a hull with faces is one of a triple of corners of a face. Only what is proven to
  // be no face is left out.
  std::vector<bool> is_edge(count * count, count == 2);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      for (std::size_t k = j + 1; k < count; ++k) {
        const Vec3 a = points[j] - points[i];
        const Vec3 b = points[k] - points[i];
        const Vec3 cross = a.cross(b);
        const double longest2 = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
        const double area = cross.norm();
        if (area > needle * longest2) {
          const double error = 1e-14 * (1.0 + longest2 / area);
          const Vec3 n = cross / area;
          if (cuts(points, points[i], n, error)) continue;
          add_once(directions.faces, n);
        }
        is_edge[i * count + j] = is_edge[i * count + k] = is_edge[j * count + k] = true;
      }
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      if (is_edge[i * count + j]) {
        add_once(directions.edges, (points[j] - points[i]).normalized());
      }
    }
  }
  return directions;
}

}  // namespace keepout
