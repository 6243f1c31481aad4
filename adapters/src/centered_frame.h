// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// A mesh's own frame: the origin in the middle of its bounds, and a unit for which no coordinate
/// exceeds `reach`. For libraries that are less exact away from the origin, or at unusual sizes.
///
/// The unit is a power of two, so only the shift rounds: by 2^-53 of the resulting coordinate.
class CenteredFrame {
 public:
  /// Precondition: reach is a power of two.
  CenteredFrame(const Box& bounds, double reach) noexcept {
    // Halved before the addition, because the bounds may span more than the range of a double.
    center_ = 0.5 * bounds.low + 0.5 * bounds.high;
    const double half = (bounds.high - center_).cwiseMax(center_ - bounds.low).maxCoeff();
    int exponent = 0;  // of the power of two above half; a mesh in one point keeps its unit
    if (half > 0.0) std::frexp(half, &exponent);
    // Beyond these limits the scale or its inverse would overflow or underflow.
    scale_ = reach * std::ldexp(1.0, std::clamp(-exponent, -1000, 900));
  }

  Vec3 from_mesh(const Vec3& point) const noexcept { return scale_ * (point - center_); }
  double from_mesh(double length) const noexcept { return scale_ * length; }
  Box from_mesh(const Box& box) const noexcept { return {from_mesh(box.low), from_mesh(box.high)}; }

 private:
  Vec3 center_;   // in the mesh frame [length]
  double scale_;  // [1 / length], a power of two
};

}  // namespace keepout
