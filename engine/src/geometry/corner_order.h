// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <utility>

#include "keepout/geometry/triangle.h"

namespace keepout {

/// The corners of a triangle, by number, in lexicographic order of their coordinates. Computing in
/// this order makes a result independent of how the triangle happens to be wound or rotated.
struct CornerOrder {
  std::array<int, 3> corner;
  bool odd;  // an odd permutation of the winding
};

inline CornerOrder corner_order(const Triangle& triangle) noexcept {
  const auto before = [&](int i, int j) {
    const Vec3& a = triangle[i];
    const Vec3& b = triangle[j];
    if (a.x() != b.x()) return a.x() < b.x();
    if (a.y() != b.y()) return a.y() < b.y();
    return a.z() < b.z();
  };
  CornerOrder order{{0, 1, 2}, false};
  const auto sort_pair = [&](int i, int j) {
    if (before(order.corner[j], order.corner[i])) {
      std::swap(order.corner[i], order.corner[j]);
      order.odd = !order.odd;
    }
  };
  sort_pair(0, 1);
  sort_pair(1, 2);
  sort_pair(0, 1);
  return order;
}

/// By the corners, each triangle's in lexicographic order: a total order, but for duplicates, that
/// does not depend on numbering or winding.
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
