// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "keepout/geometry/pose.h"

namespace keepout {

/// A convex region that something must not leave: one side of a plane, or all points within a
/// distance of a plane, a line or a point.
class Region {
 public:
  /// The form of a region: each has a function of its name.
  enum class Kind : std::uint8_t { half_space, slab, tube, ball };

  /// Returns the side of a plane through `point` that `into` points to. Like the functions below it
  /// throws Error for a direction of no length, a number that is not finite or too large, or a
  /// distance that is not above 0.
  static Region half_space(const Vec3& point, const Vec3& into);
  /// Returns all within `half_width` of a plane: a corridor, such as that of Li et al. (2020), 1 mm
  /// to each side of the sagittal plane.
  static Region slab(const Vec3& point, const Vec3& normal, double half_width);
  /// Returns all within `radius` of a line: a cylinder without ends, or a line with a tolerance.
  static Region tube(const Vec3& point, const Vec3& direction, double radius);
  /// Returns all within `radius` of a point.
  static Region ball(const Vec3& center, double radius);

  /// Returns the distance of a point from the region; below 0 it is inside, so far from the
  /// boundary. The excess is convex and its slope is at most 1: on a path with a second derivative
  /// of at most M it is nowhere more than M / 8 above its larger value at the ends. [length]
  double excess(const Vec3& point) const noexcept;

  /// Returns the direction in which the excess grows, a unit vector; zero in the middle, where it
  /// grows alike on all sides.
  Vec3 outward(const Vec3& point) const noexcept;

  Kind kind() const noexcept { return kind_; }  ///< Returns the form of the region.
  /// Returns a point of the plane or the line, or the center. [length]
  const Vec3& origin() const noexcept { return origin_; }
  /// Returns the unit vector into a half-space, across a slab or along a tube; zero of a ball.
  const Vec3& direction() const noexcept { return direction_; }
  /// Returns the largest distance from plane, line or center; 0 for a half-space. [length]
  double radius() const noexcept { return radius_; }

 private:
  Region(Kind kind, const Vec3& origin, const Vec3& direction, const Mat3& across, double radius);

  Kind kind_;
  Vec3 origin_;
  Vec3 direction_;
  Mat3 across_;  // removes from a vector its part along the plane or line; of a half-space the
                 // first row points out
  double radius_;
};

}  // namespace keepout
