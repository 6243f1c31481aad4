// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "keepout/activation/prepared_triangle.h"

namespace keepout {

/// A lower bound of the distance of t z from a prepared triangle, minus a level: `at_0` + t `slope`
/// (Lemma 2 of docs/certified-step.md).
struct Line {
  double at_0;
  double slope;

  /// Returns true if the bound is at least -slack on the whole motion, which proves the level
  /// (Lemma 1).
  bool proves_clear(double slack) const noexcept {
    return at_0 >= -slack && at_0 + slope >= -slack;
  }
};

/// Returns the bound that the normal of a closest point gives.
inline Line line_of(const PreparedTriangle::Nearest& nearest, const Vec3& z,
                    double level) noexcept {
  return {-nearest.support - level, nearest.normal.dot(z)};
}

/// Returns the normal of a plane that proves the level on the motion from 0 to z: dist(t z, T) >=
/// level - slack for t in [0, 1]. Returns nothing if the motion comes closer, or if rounding hides
/// the answer. Precondition: level <= prepared.distance() + slack, and far above the rounding of
/// lengths. [length]
std::optional<Vec3> proof_of_clearance(const PreparedTriangle& prepared, const Vec3& z,
                                       double level, double slack) noexcept;

/// Returns true if a plane with normal n is such a proof: the triangle, grown by `level`, is on one
/// side, and both ends of the motion on the other. `corners`: relative to the tip.
inline bool separates(const Vec3& n, const Triangle& corners, const Vec3& z, double level,
                      double slack) noexcept {
  return Line{-support(corners, n) - level, n.dot(z)}.proves_clear(slack);
}

}  // namespace keepout
