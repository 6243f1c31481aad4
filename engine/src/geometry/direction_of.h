// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// Below it squares are rounded to few digits, or to zero, and no length can be told from them.
constexpr double least_length_of_squares = 1e-140;

/// The same direction, the largest coordinate from 1 to 2: times a power of two, so without
/// rounding. Zero, and what is not finite, stays as it is.
inline Vec3 at_moderate_length(const Vec3& v) noexcept {
  const double largest = v.cwiseAbs().maxCoeff();
  if (!(largest > 0.0) || !v.allFinite()) return v;
  const int exponent = std::ilogb(largest);
  return v.unaryExpr([exponent](double x) { return std::scalbn(x, -exponent); });
}

/// Returns v at unit length; zero if it has none. For lengths whose square does not underflow.
inline Vec3 unit(const Vec3& v) noexcept {
  const double length = v.norm();
  return length > 0.0 ? Vec3(v / length) : Vec3::Zero();
}

/// Returns v at unit length, however short it is; zero for zero and if a coordinate is not finite.
inline Vec3 direction_of(const Vec3& v) noexcept {
  const double length = v.norm();
  if (length > least_length_of_squares) return v / length;
  const Vec3 longer = at_moderate_length(v);
  return longer.isZero(0.0) || !longer.allFinite() ? Vec3(Vec3::Zero())
                                                   : Vec3(longer / longer.norm());
}

}  // namespace keepout
