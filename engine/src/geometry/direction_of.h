// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// Below this length, squares lose too many digits, or underflow.
constexpr double least_length_of_squares = 1e-140;

/// Returns the same direction with its largest coordinate from 1 to 2. The scale is a power of two,
/// so there is no rounding. Zero and vectors that are not finite are returned unchanged.
inline Vec3 at_moderate_length(const Vec3& v) noexcept {
  const double largest = v.cwiseAbs().maxCoeff();
  if (!(largest > 0.0) || !v.allFinite()) return v;
  const int exponent = std::ilogb(largest);
  return v.unaryExpr([exponent](double x) { return std::scalbn(x, -exponent); });
}

/// Returns v at unit length, or zero for zero. For lengths whose square does not underflow.
inline Vec3 unit(const Vec3& v) noexcept {
  const double length = v.norm();
  return length > 0.0 ? Vec3(v / length) : Vec3::Zero();
}

/// Returns v at unit length, however short it is. Returns zero for zero, and if a coordinate is not
/// finite.
inline Vec3 direction_of(const Vec3& v) noexcept {
  const double length = v.norm();
  if (length > least_length_of_squares) return v / length;
  const Vec3 longer = at_moderate_length(v);
  return longer.isZero(0.0) || !longer.allFinite() ? Vec3(Vec3::Zero())
                                                   : Vec3(longer / longer.norm());
}

}  // namespace keepout
