// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "keepout/geometry/pose.h"

namespace keepout {

/// A convex region that a guided point or direction must not leave (see Guide). It is one side of a
/// plane, or all points near a plane, a line or a point.
class Region {
 public:
  /// The form of a region. A static function of the same name makes it.
  enum class Kind : std::uint8_t { half_space, slab, tube, ball };

  /// Returns the side of a plane through `point` that `into` points to. Like the functions below,
  /// throws Error for a zero direction, a number that is not finite or too large, or a distance
  /// that is not above 0.
  static Region half_space(const Vec3& point, const Vec3& into);
  /// Returns all points within `half_width` of a plane: a corridor. The corridor of Li et al.
  /// (2020) is 1 mm to each side of the sagittal plane.
  static Region slab(const Vec3& point, const Vec3& normal, double half_width);
  /// Returns all points within `radius` of a line: an infinite cylinder.
  static Region tube(const Vec3& point, const Vec3& direction, double radius);
  /// Returns all points within `radius` of a point.
  static Region ball(const Vec3& center, double radius);

  /// Returns the signed distance of a point from the region, below 0 inside. This distance, the
  /// excess, is convex, and its slope is at most 1. Let a path over [0, 1] have a second derivative
  /// of at most M. Its excess is then at most M / 8 above the larger of the values at the ends.
  /// [length]
  double excess(const Vec3& point) const noexcept;

  /// Returns the unit vector along which the excess grows. Zero on the middle plane, the line or
  /// the center, from where the excess grows in opposite directions.
  Vec3 outward(const Vec3& point) const noexcept;

  Kind kind() const noexcept { return kind_; }  ///< Returns the form of the region.
  /// Returns a point of the plane or the line, or the center. [length]
  const Vec3& origin() const noexcept { return origin_; }
  /// Returns the unit vector into a half-space, normal to a slab or along a tube; zero for a ball.
  const Vec3& direction() const noexcept { return direction_; }
  /// Returns the largest distance from plane, line or center; 0 for a half-space. [length]
  double radius() const noexcept { return radius_; }

 private:
  Region(Kind kind, const Vec3& origin, const Vec3& direction, const Mat3& across, double radius);

  Kind kind_;
  Vec3 origin_;
  Vec3 direction_;
  /// Removes from a vector its component along the plane or line. For a half-space, the first row
  /// points out of the region.
  Mat3 across_;
  double radius_;
};

}  // namespace keepout
