// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/pose.h"

namespace keepout {

/// A convex region that something is to stay in: one side of a plane, or all points within a
/// distance of a plane, a line or a point. What is guarded against is leaving it; meshes are what
/// is not to be entered.
class Region {
 public:
  /// The side of a plane through `point` that `into` points to. Like those below it throws Error
  /// for a direction of no length, a number that is not finite or too large, or a distance that is
  /// not above 0.
  static Region half_space(const Vec3& point, const Vec3& into);
  /// All within `half_width` of a plane: the paper's corridor of +-1 mm about the sagittal plane.
  static Region slab(const Vec3& point, const Vec3& normal, double half_width);
  /// All within `radius` of a line: a cylinder without ends, or a line with a tolerance.
  static Region tube(const Vec3& point, const Vec3& direction, double radius);
  /// All within `radius` of a point.
  static Region ball(const Vec3& center, double radius);

  /// How far a point is out of the region; below 0 it is in it, so far from its boundary. Convex,
  /// and no steeper than 1: so on a way that is bent by at most M between its ends, it is nowhere
  /// more than at one of them, and M / 8. [length]
  double excess(const Vec3& point) const noexcept;

  /// The direction in which the excess grows: a unit vector; zero where it grows alike on all
  /// sides, in the middle.
  Vec3 outward(const Vec3& point) const noexcept;

  /// A point of the plane, the line, or the centre. [length]
  const Vec3& origin() const noexcept { return origin_; }
  /// How far from that the region reaches; 0 for one side of a plane. [length]
  double radius() const noexcept { return radius_; }

 private:
  Region(const Vec3& origin, const Mat3& across, double radius);

  Vec3 origin_;
  Mat3 across_;  // takes from a way what is along plane or line
  double radius_;
  bool one_sided_ = false;  // then the first row of across_ points out
};

}  // namespace keepout
