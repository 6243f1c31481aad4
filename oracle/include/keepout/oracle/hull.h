// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "keepout/oracle/distance.h"

namespace keepout::oracle {

/// The convex hull of a few points: a point, a segment, a flat blade or a solid one.
///
/// The distance from a triangle is the least over edges of the hull and the triangle, and over
/// faces of the hull and the triangle's edges; each is a distance of a segment and a triangle,
/// bracketed by narrow_distance(). Which pairs and triples of points are edges and faces is found
/// once. Doubtful ones are included: all of them are within the hull, so they cannot make the
/// distance too small. Only a triangle that is wholly inside is found otherwise, as a point in a
/// solid.
///
/// Most pairs are passed over by a direction that separates them. However it was found, no pair is
/// nearer than its heights along it say.
class Hull {
 public:
  static constexpr std::size_t most_points = 64;

  /// Throws std::invalid_argument for no point or more than most_points.
  explicit Hull(std::span<const Vec3> points);

  std::span<const Vec3> points() const noexcept { return points_; }
  /// Moves the hull rigidly; a segment may change its length as well. Precondition: as many points.
  void move_to(std::span<const Vec3> points);

  /// A ball that contains the hull. [length]
  const Vec3& center() const noexcept { return center_; }
  double radius() const noexcept { return radius_; }

  /// Returns a lower bound of the distance from a point, cheap and rounded. [length]
  double least_distance(const Vec3& point) const noexcept;

  /// Brackets the distance from a triangle narrowly; 0 if and only if they touch, or the triangle
  /// is inside by more than rounding. If it is surely more than `enough`, the bracket may be wide.
  Bracket distance(const Triangle& triangle,
                   double enough = std::numeric_limits<double>::infinity()) const;

 private:
  Vec3 direction_from(const Triangle& triangle) const noexcept;
  bool contains(const Vec3& point) const noexcept;

  std::vector<Vec3> points_;
  Vec3 center_ = Vec3::Zero();
  double radius_ = 0.0;
  std::vector<std::array<std::uint8_t, 2>> edges_;
  std::vector<std::array<std::uint8_t, 3>> faces_;
};

}  // namespace keepout::oracle
