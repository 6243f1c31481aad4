// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// The tip as the sum of two floats, so that what is near it keeps its digits when it is looked at
/// in float.
struct FloatTip {
  float high[3];
  float low[3];
};

FloatTip float_tip(const Vec3& tip) noexcept;

/// How near is near. All are rounded up.
struct FloatReach {
  float margin;    // to keep from the motion [length]
  float relative;  // what rounding adds: so much of |v - tip| of the farthest corner v ...
  float slack;     // ... and this [length]
  float boxes;     // margin and rounding, for boxes [length]
};

/// `error`: of the coordinates in leaves. `longest`: no motion that is looked at is longer.
FloatReach float_reach(double margin, double longest, const Vec3& tip, double error) noexcept;

/// What is known of sixteen things while the tip stays where it is: unit vectors, and how far the
/// margin is kept along each. That the plane between thing and tip along a vector is valid is
/// checked by what holds the thing, however the vector was come by.
struct ProofBlock {
  static constexpr std::size_t lanes = 16;

  alignas(64) float n[3][lanes];   // [axis][lane]
  alignas(64) float clear[lanes];  // of the margin at the tip, less rounding [length]
};

}  // namespace keepout
