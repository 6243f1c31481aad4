// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/convex_tool.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "keepout/error.h"
#include "keepout/option_table.h"

namespace keepout {
namespace {

// Squares and cubes of lengths must stay finite. A step has the same limit.
constexpr double largest_length = 1e30;

// Cubes of the lengths between two points must not underflow.
constexpr double least_gap = 1e-30;

/// Returns each place once, because two equal points span no edge. Stops at too many points, as the
/// time grows with their square.
std::vector<Vec3> distinct(std::vector<Vec3> points) {
  std::vector<Vec3> kept;
  for (const Vec3& p : points) {
    if (kept.size() > ConvexTool::most_points) break;
    if (std::find(kept.begin(), kept.end(), p) == kept.end()) kept.push_back(p);
  }
  return kept;
}

void check(const std::vector<Vec3>& points, double radius) {
  if (points.empty() || points.size() > ConvexTool::most_points) {
    throw Error("a convex tool has 1 to " + std::to_string(ConvexTool::most_points) +
                " points in different places, not " + (points.empty() ? "none" : "more") +
                ": leave out points inside the hull of the others");
  }
  if (!(radius >= 0.0 && radius <= largest_length)) {
    throw Error("the radius of a convex tool must be a number from 0 to 1e30, not " +
                text_of(radius));
  }
  for (const Vec3& p : points) {
    if (!(p.array().abs() <= largest_length).all()) {
      throw Error("the coordinates of a convex tool must be numbers of at most 1e30");
    }
    for (const Vec3* other = &points.front(); other != &p; ++other) {
      if ((p - *other).cwiseAbs().maxCoeff() < least_gap) {
        throw Error(
            "two points of a convex tool are nearer than 1e-30 to each other, but not in the "
            "same place: leave one of them out");
      }
    }
  }
}

Ball ball_around(const std::vector<Vec3>& points, double radius) {
  Box box{points.front(), points.front()};
  for (const Vec3& p : points) {
    box.low = box.low.cwiseMin(p);
    box.high = box.high.cwiseMax(p);
  }
  double farthest = 0.0;
  for (const Vec3& p : points) farthest = std::max(farthest, (p - box.center()).norm());
  // Wider by a few roundings.
  return {box.center(), (farthest + radius) * (1.0 + 1e-15)};
}

// If the height of three corners is below this fraction of their longest side, they are on a line
// up to rounding and have no normal.
constexpr double needle = 1e-14;

// A few roundings of a unit vector.
constexpr double same_direction = 1e-15;

void add_once(std::vector<Vec3>& directions, const Vec3& n) {
  const bool known = std::any_of(directions.begin(), directions.end(), [&](const Vec3& d) {
    return (d - n).norm() <= same_direction || (d + n).norm() <= same_direction;
  });
  if (!known) directions.push_back(n);
}

/// Returns true if points are clearly on both sides of a plane, beyond rounding and the error of
/// its normal.
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

/// Unit vectors, one of each opposite pair.
struct HullDirections {
  std::vector<Vec3> faces;  // at least the normals of the hull's faces
  std::vector<Vec3> edges;  // at least the directions of its edges
};

/// Returns the directions of the convex hull of points, which may be flat, straight or a point.
/// Tries every triple, so that degenerate cases need no special code: O(n^4), 10 ms for 64 points.
HullDirections hull_directions(std::span<const Vec3> points) {
  const std::size_t count = points.size();
  HullDirections directions;
  // Each edge of a hull with faces is in a triple of corners of a face. A triple is left out only
  // if it is proved to be no face.
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

}  // namespace

ConvexTool::ConvexTool(std::vector<Vec3> points, double radius)
    : points_(distinct(std::move(points))), radius_(radius) {
  check(points_, radius_);
  bounding_ball_ = ball_around(points_, radius_);
  HullDirections directions = hull_directions(points_);
  face_normals_ = std::move(directions.faces);
  edge_directions_ = std::move(directions.edges);
}

ConvexTool ConvexTool::sphere(double radius) { return {{Vec3::Zero()}, radius}; }

ConvexTool ConvexTool::capsule(const Vec3& from, const Vec3& to, double radius) {
  return {{from, to}, radius};
}

ConvexTool ConvexTool::box(const Box& box) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) {
    corners.emplace_back((i & 1 ? box.high : box.low).x(), (i & 2 ? box.high : box.low).y(),
                         (i & 4 ? box.high : box.low).z());
  }
  return {std::move(corners), 0.0};
}

ConvexTool ConvexTool::hull(std::span<const Vec3> points, double radius) {
  return {{points.begin(), points.end()}, radius};
}

ConvexTool ConvexTool::rotated(const Eigen::Matrix3d& rotation) const {
  const Eigen::Matrix3d unit = rotation.transpose() * rotation;
  if (!unit.isIdentity(1e-9) || !(rotation.determinant() > 0.0)) {
    throw Error("a tool must be rotated by a rotation matrix: orthogonal, with determinant 1");
  }
  std::vector<Vec3> turned;
  for (const Vec3& p : points_) turned.push_back(rotation * p);
  return {std::move(turned), radius_};
}

const Vec3& ConvexTool::support(const Vec3& n) const noexcept {
  const Vec3* best = &points_.front();
  double farthest = n.dot(*best);
  for (const Vec3& p : points_) {
    const double far = n.dot(p);
    if (!(far > farthest)) continue;
    farthest = far;
    best = &p;
  }
  return *best;
}

}  // namespace keepout
