// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// A triangle relative to the tip.
struct TriangleFromTip {
  std::array<Vec3, 3> corners;  // in an order that does not depend on the winding
  Vec3 normal;                  // unit, of either sign; zero for a needle that is almost a segment
};

TriangleFromTip triangle_from_tip(const Triangle& triangle, const Vec3& tip) noexcept;

/// Returns the largest normal . p over the points p of the triangle that are in the ball of
/// `radius` around the tip, or -infinity without such points. The result is never too small. It is
/// at most the value for a ball larger by `slack`, and for a needle at most that of the whole
/// triangle. [length]
double support_within(const TriangleFromTip& triangle, const Vec3& normal, double radius,
                      double slack) noexcept;

}  // namespace keepout
