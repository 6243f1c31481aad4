// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// A triangle as the tip sees it.
struct TriangleFromTip {
  std::array<Vec3, 3> corners;  // relative to the tip, in an order that the winding has no part in
  Vec3 normal;                  // unit, either way; zero for a needle that is all but a segment
};

TriangleFromTip triangle_from_tip(const Triangle& triangle, const Vec3& tip) noexcept;

/// The largest normal . p over the points p of the triangle that are in the ball of `radius` around
/// the tip; -infinity if there are none. Never too small; too large by no more than the triangle's
/// part in a ball larger by `slack` has it, for a needle its whole. [length]
/// Precondition: `slack` is above the rounding of the corners, some 1e-15 of their distance.
double support_within(const TriangleFromTip& triangle, const Vec3& normal, double radius,
                      double slack) noexcept;

}  // namespace keepout
