// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "keepout/activation/activation_rule.h"

namespace keepout {

/// The most planes that a rule adds in a cycle. A cycle needs few, and about a hundred under the
/// tip of a cone of 400 faces; more than that is an endless loop.
inline constexpr std::size_t most_cutting_planes = 192;

/// The paper's plane {n, p} (eq. 2) with a margin: all motions d that end at least `margin` beyond
/// the plane through the hit's closest point. `normal` is a unit vector.
inline HalfSpace plane_through(const Hit& hit, const Vec3& normal, double margin) noexcept {
  return {normal, normal.dot(hit.closest.offset) + margin, hit.triangle};
}

/// The unit vector from the hit's closest point to the tip. Precondition: they are apart.
inline Vec3 away_from(const Hit& hit) noexcept {
  return -hit.closest.offset / hit.closest.distance;
}

/// Whether the tip is on the side of the hit's face to which `normal` points: N^T (x - CP) >= 0,
/// to within rounding. A tool that slides along a face sits on it to the last bit, now above and
/// now below; read without tolerance, the face would vanish under it every other cycle.
bool on_positive_side(const CycleProblem& problem, const Hit& hit, const Vec3& normal) noexcept;

/// Whether the tip lies on the surface, to within rounding: x - CP has no direction there.
bool touches(const CycleProblem& problem, const Hit& hit) noexcept;

/// Returns the retreat of a tip that is too close: the target without its part towards the surface,
/// plus `lift` along the unit vector `off`, away from the surface. At most as long as the radius of
/// the motion sphere. [length]
Vec3 retreat_target(const CycleProblem& problem, const Vec3& off, double lift) noexcept;

/// Relaxes the planes that demand motion until they allow standing still. Returns true if any
/// changed.
bool let_stand_still(HalfSpaceBuffer& planes) noexcept;

/// Whether a motion satisfies all planes, to within half of the rounding of a position.
bool satisfies(const Vec3& motion, std::span<const HalfSpace> planes, double rounding) noexcept;

/// Whether a triangle has called for one of the planes.
bool has_plane(TriangleId source, std::span<const HalfSpace> planes) noexcept;

}  // namespace keepout
