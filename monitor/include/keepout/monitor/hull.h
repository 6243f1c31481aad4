// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "keepout/monitor/distance.h"

namespace keepout::monitor {

/// The convex hull of a few points: a point, a segment, a flat blade or a solid.
///
/// The distance from a triangle is the least of many distances. These are from edges of the hull to
/// the triangle, and from faces of the hull to edges of the triangle. Both kinds use
/// a bracket. The constructor determines which pairs and triples of points are edges and
/// faces. It includes doubtful ones: they are within the hull, so they cannot make the distance too
/// small. A triangle that is wholly inside is detected separately, by a point in the solid.
///
/// A separating direction excludes most pairs. In any direction, the heights of a pair differ by at
/// most the distance of the pair.
class Hull {
 public:
  static constexpr std::size_t most_points = 64;

  /// Throws std::invalid_argument for no point or more than most_points.
  explicit Hull(std::span<const Vec3> points);

  std::span<const Vec3> points() const noexcept { return points_; }
  /// Moves the hull rigidly; a segment may also change its length. Precondition: the number of
  /// points is unchanged.
  void move_to(std::span<const Vec3> points);

  /// Returns the center and the radius of a ball that contains the hull. [length]
  const Vec3& center() const noexcept { return center_; }
  double radius() const noexcept { return radius_; }

  /// Returns a lower bound of the distance from a point, cheap and rounded. [length]
  double least_distance(const Vec3& point) const noexcept;
  /// Returns a vector from a point to a near point of the hull; of a segment to the nearest one.
  Vec3 way_from(const Vec3& point) const noexcept;

  /// Returns a bracket of the distance from a triangle, as narrow as those of `between`. It is 0 if
  /// and only if they touch, or the triangle is inside by more than rounding. If the distance is
  /// certainly more than `enough`, the bracket may be wide.
  Bracket distance(const Triangle& triangle, BracketFunction between,
                   double enough = std::numeric_limits<double>::infinity()) const;

  /// Like distance(triangle, bracket_distance), but also returns the direction from the triangle to
  /// the hull.
  Gap gap(const Triangle& triangle) const noexcept;

 private:
  template <class Between>
  Bracket least(const Triangle& triangle, double enough, const Between& between) const;
  Vec3 direction_from(const Triangle& triangle) const noexcept;
  bool contains(const Vec3& point) const noexcept;

  std::vector<Vec3> points_;
  Vec3 center_ = Vec3::Zero();
  double radius_ = 0.0;
  std::vector<std::array<std::uint8_t, 2>> edges_;
  std::vector<std::array<std::uint8_t, 3>> faces_;
};

}  // namespace keepout::monitor
