// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// A rigid convex tool: the convex hull of some points, its core, grown by a radius. One point is a
/// sphere, two are a capsule, eight a box, any others a hull with edges as round as the radius.
///
/// Its origin is the tip, its axes are the mesh's. A tool in another orientation is turned once,
/// when it is made.
class ConvexTool {
 public:
  static constexpr std::size_t most_points = 64;  // of a core

  /// Makes a ball around the origin. Like the others below it throws Error if a length is not
  /// finite or above 1e30, a radius is below 0, two different points are nearer than 1e-30 to each
  /// other, or there is no point or more than most_points. [length]
  static ConvexTool sphere(double radius);
  /// Makes a cylinder with round ends: all within `radius` of a segment. [length]
  static ConvexTool capsule(const Vec3& from, const Vec3& to, double radius);
  /// Makes a box along the axes. [length]
  static ConvexTool box(const Box& box);
  /// Makes all within `radius` of the convex hull of points, in any order. [length]
  static ConvexTool hull(std::span<const Vec3> points, double radius = 0.0);

  /// Returns the tool turned about its origin. Throws Error unless the matrix is a rotation.
  ConvexTool rotated(const Eigen::Matrix3d& rotation) const;

  /// Returns the core's points, as they were given. [length]
  std::span<const Vec3> points() const noexcept { return points_; }
  double radius() const noexcept { return radius_; }  // [length]

  /// Returns a ball that contains the whole tool, with its radius.
  const Ball& bounding_ball() const noexcept { return bounding_ball_; }

  /// Returns the point of the core farthest along n; of equally far points the first given.
  const Vec3& support(const Vec3& n) const noexcept;

  /// Returns unit vectors, one of each opposite pair: at least the normals of the core's faces. The
  /// least motion that separates the core from another convex body is along a face normal of
  /// either, or a cross product of their edges.
  std::span<const Vec3> face_normals() const noexcept { return face_normals_; }
  /// Like face_normals, for the directions of the core's edges.
  std::span<const Vec3> edge_directions() const noexcept { return edge_directions_; }

 private:
  ConvexTool(std::vector<Vec3> points, double radius);

  std::vector<Vec3> points_;
  double radius_;
  Ball bounding_ball_;
  std::vector<Vec3> face_normals_;
  std::vector<Vec3> edge_directions_;
};

}  // namespace keepout
