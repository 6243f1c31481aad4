// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "keepout/activation/facet.h"

namespace keepout {

/// Returns the normal of a plane that proves that the whole motion from 0 to z stays `level` away
/// from the facet: dist(t z, T) >= level - slack for all t in [0, 1]. Returns nothing if the motion
/// comes closer, or if rounding hides the answer. Precondition: level <= facet.distance(), and far
/// above the rounding of lengths. [length]
std::optional<Vec3> proof_of_clearance(const Facet& facet, const Vec3& z, double level,
                                       double slack) noexcept;

/// Returns true if the plane across the shortest segment from the tip to the facet is such a proof:
/// the fastest test.
inline bool clears_at_once(const Facet& facet, const Vec3& z, double level, double slack) noexcept {
  const double at_0 = -facet.at_tip().support - level;
  return at_0 >= -slack && at_0 + facet.normal().dot(z) >= -slack;
}

/// Returns true if there is such a proof: see proof_of_clearance.
inline bool keeps_clear(const Facet& facet, const Vec3& z, double level, double slack) noexcept {
  return proof_of_clearance(facet, z, level, slack).has_value();
}

/// Returns true if a plane with normal n is such a proof: the triangle, relative to the tip and
/// grown by `level`, is on one side, and both ends of the motion are on the other.
inline bool separates(const Vec3& n, const Triangle& corners, const Vec3& z, double level,
                      double slack) noexcept {
  const double at_0 = -support(corners, n) - level;
  return at_0 >= -slack && at_0 + n.dot(z) >= -slack;
}

}  // namespace keepout
