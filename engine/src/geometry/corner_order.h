// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// The corners of a triangle, by number, in lexicographic order of their coordinates. A result that
/// is computed in this order does not depend on the triangle's winding or rotation.
struct CornerOrder {
  std::array<int, 3> corner;
  bool odd;  // an odd permutation of the winding
};

/// Returns the order of a triangle's corners. The earlier in the winding comes first of equal
/// corners.
inline CornerOrder corner_order(const Triangle& triangle) noexcept {
  // Without branches, which no processor could predict. The place of a corner is the number of
  // corners before it, and equal corners keep their order.
  const auto before = [&](int i, int j) {
    const Vec3& a = triangle[i];
    const Vec3& b = triangle[j];
    const int in_plane = int{a.y() < b.y()} | (int{a.y() == b.y()} & int{a.z() < b.z()});
    return int{a.x() < b.x()} | (int{a.x() == b.x()} & in_plane);
  };
  const int one_before_zero = before(1, 0);
  const int two_before_zero = before(2, 0);
  const int two_before_one = before(2, 1);
  CornerOrder order;
  order.corner[one_before_zero + two_before_zero] = 0;
  order.corner[1 - one_before_zero + two_before_one] = 1;
  order.corner[2 - two_before_zero - two_before_one] = 2;
  order.odd = ((one_before_zero ^ two_before_zero ^ two_before_one) & 1) != 0;
  return order;
}

/// Returns true if one triangle comes before the other, comparing their corners in lexicographic
/// order. This is a total order, except for duplicates, that does not depend on numbering or
/// winding.
inline bool comes_before(const Triangle& one, const Triangle& other) noexcept {
  const CornerOrder mine = corner_order(one);
  const CornerOrder theirs = corner_order(other);
  for (int i = 0; i < 3; ++i) {
    const Vec3& a = one[mine.corner[i]];
    const Vec3& b = other[theirs.corner[i]];
    for (int axis = 0; axis < 3; ++axis) {
      if (a[axis] != b[axis]) return a[axis] < b[axis];
    }
  }
  return false;
}

}  // namespace keepout
