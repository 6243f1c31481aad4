// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// A rigid convex tool: the convex hull of points (its core), grown by a radius. One point makes a
/// sphere, two make a capsule, eight can make a box. Other points make a hull with edges rounded by
/// the radius.
///
/// The origin of the tool is the tip, and its axes are those of the mesh. For another orientation,
/// make a rotated() tool.
class ConvexTool {
 public:
  static constexpr std::size_t most_points = 64;  // of a core

  /// Returns a ball around the origin [length]. Like the functions below, throws Error for a length
  /// that is not finite or above 1e30, or a radius below 0. Also throws Error for two different
  /// points less than 1e-30 apart, and unless there are 1 to most_points points.
  static ConvexTool sphere(double radius);
  /// Returns a cylinder with round ends: all points within `radius` of a segment. [length]
  static ConvexTool capsule(const Vec3& from, const Vec3& to, double radius);
  /// Returns an axis-aligned box. [length]
  static ConvexTool box(const Box& box);
  /// Returns all points within `radius` of the convex hull of `points`, which may be in any order.
  /// [length]
  static ConvexTool hull(std::span<const Vec3> points, double radius = 0.0);

  /// Returns the tool rotated about its origin. Throws Error unless the matrix is a rotation.
  ConvexTool rotated(const Eigen::Matrix3d& rotation) const;

  /// Returns the points of the core, as given. [length]
  std::span<const Vec3> points() const noexcept { return points_; }
  double radius() const noexcept { return radius_; }  // [length]

  /// Returns a ball that contains the whole tool, including its radius.
  const Ball& bounding_ball() const noexcept { return bounding_ball_; }

  /// Returns the point of the core farthest along n; among equally far points, the first one given.
  const Vec3& support(const Vec3& n) const noexcept;

  /// Returns unit vectors that include the normals of the core's faces, one for each opposite pair.
  /// The shortest motion that separates two convex bodies is along a face normal of either body, or
  /// along the cross product of an edge of each.
  std::span<const Vec3> face_normals() const noexcept { return face_normals_; }
  /// Returns the directions of the core's edges, like face_normals.
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
