// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/shapes.h"

namespace keepout {

/// The point of a segment that is nearest to the origin.
struct OnSegment {
  Vec3 point;
  int end;  // 0: a, 1: b, -1: in between
};

/// Returns the nearest point of the segment from a to b. Its last digits depend on the order of a
/// and b.
inline OnSegment closest_on_segment(const Vec3& a, const Vec3& b) noexcept {
  const Vec3 along = b - a;
  const double from_a = -a.dot(along);
  const double from_b = b.dot(along);
  if (!(from_a > 0.0)) return {a, 0};
  if (!(from_b > 0.0)) return {b, 1};
  // Measured from the nearer end, where the rounding of the parameter matters least.
  const double length2 = along.squaredNorm();
  if (from_a <= from_b) return {a + along * (from_a / length2), -1};
  return {b - along * (from_b / length2), -1};
}

}  // namespace keepout
