// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "keepout/activation/activation_rule.h"

namespace keepout {

/// The most planes that a rule adds in one search of a cycle. A search usually needs few planes,
/// but about a hundred at the apex of a cone of 400 faces. The limit prevents an endless loop.
inline constexpr std::size_t most_cutting_planes = 192;

/// Returns the plane {n, p} of Li et al. (2020), eq. 2, with a clearance: it allows all motions
/// that end at least `clearance` beyond the plane through the hit's closest point. `normal` is a
/// unit vector.
inline HalfSpace plane_through(const Hit& hit, const Vec3& normal, double clearance) noexcept {
  return {normal, normal.dot(hit.closest.offset) + clearance, hit.triangle};
}

/// Returns the unit vector from the hit's closest point to the tip. Precondition: they are apart.
inline Vec3 away_from(const Hit& hit) noexcept {
  return -hit.closest.offset / hit.closest.distance;
}

/// Returns true if the tip is on the side of the hit's face to which `normal` points: N^T (x - CP)
/// >= 0, to within rounding. A tool that slides along a face is above or below it by rounding.
/// Without a tolerance the rule would miss the face in every other cycle.
bool on_positive_side(const RuleInput& input, const Hit& hit, const Vec3& normal) noexcept;

/// Returns true if the tip is on the surface, to within the rounding of positions. The direction
/// from the closest point to the tip is then undefined. (The certified rule has a larger threshold:
/// touching_within.)
bool touches(const RuleInput& input, const Hit& hit) noexcept;

/// Returns the retreat of a tip that is too close: the target without its part towards the surface,
/// plus `lift` along `off`. `off`: the unit vector away from the surface. The retreat is at most as
/// long as the radius of the motion sphere. [length]
Vec3 retreat_target(const RuleInput& input, const Vec3& off, double lift) noexcept;

/// Relaxes the planes that demand motion until they allow zero motion. Returns true if any plane
/// changed.
bool let_stand_still(HalfSpaceBuffer& planes) noexcept;

/// Returns true if a motion satisfies all planes, to within half of the rounding of a position.
bool satisfies(const Vec3& motion, std::span<const HalfSpace> planes, double rounding) noexcept;

/// Returns true if one of the planes has the triangle as its source.
bool has_plane(TriangleId triangle, std::span<const HalfSpace> planes) noexcept;

}  // namespace keepout
