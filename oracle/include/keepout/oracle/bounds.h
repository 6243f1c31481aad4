// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/oracle/distance.h"

namespace keepout::oracle {

/// An axis-aligned box. [length]
struct Bounds {
  Vec3 low;
  Vec3 high;

  /// Boxes that touch overlap. Exact: comparisons only.
  bool overlaps(const Bounds& other) const noexcept {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
  bool contains(const Bounds& other) const noexcept {
    return (low.array() <= other.low.array()).all() && (other.high.array() <= high.array()).all();
  }
};

/// The smallest boxes: exact.
inline Bounds bounds_of(const Triangle& t) noexcept {
  return {t[0].cwiseMin(t[1]).cwiseMin(t[2]), t[0].cwiseMax(t[1]).cwiseMax(t[2])};
}
inline Bounds bounds_of(const Segment& s) noexcept {
  return {s.from.cwiseMin(s.to), s.from.cwiseMax(s.to)};
}
inline Bounds united(const Bounds& a, const Bounds& b) noexcept {
  return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high)};
}

/// A box that holds everything within `reach` [length, >= 0] of the box. The sum is rounded, by at
/// most 2^-53 of itself, so 2^-52 of itself, at least the distance to the next double, is added.
inline Bounds inflated(const Bounds& box, double reach) noexcept {
  const Eigen::Array3d low = box.low.array() - reach;
  const Eigen::Array3d high = box.high.array() + reach;
  return {low - (low.abs() * 0x1p-52 + 1e-300), high + (high.abs() * 0x1p-52 + 1e-300)};
}

}  // namespace keepout::oracle
