// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/convex_tool.h"

#include <Eigen/LU>
#include <algorithm>
#include <string>
#include <utility>

#include "hull_directions.h"
#include "keepout/error.h"

namespace keepout {
namespace {

// Squares and cubes of lengths must stay finite; a step keeps to the same limit.
constexpr double largest_length = 1e30;

/// Each place once: two points in the same place span no edge. Ends where there are too many, for
/// its time grows with the square of what it keeps.
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
                ": leave out those inside of the hull of the others");
  }
  if (!(radius >= 0.0 && radius <= largest_length)) {
    throw Error("the radius of a convex tool must be a number that is not below 0, nor above 1e30");
  }
  for (const Vec3& p : points) {
    if (!(p.array().abs() <= largest_length).all()) {
      throw Error("the coordinates of a convex tool must be numbers of at most 1e30");
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
  // Wider by some roundings.
  return {box.center(), (farthest + radius) * (1.0 + 1e-15)};
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
    throw Error("a tool is turned by a rotation: an orthogonal matrix whose determinant is 1");
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
