// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/vec3.h"

namespace keepout {

/// An axis-aligned box. [length]
struct Box {
  Vec3 low;   // the corner with the least coordinates
  Vec3 high;  // the corner with the largest

  /// Halfway between the corners. [length]
  Vec3 center() const noexcept { return 0.5 * (low + high); }
  /// The lengths of its sides, >= 0 unless it is empty. [length]
  Vec3 size() const noexcept { return high - low; }
};

/// From a point to a box, 0 within it. [length]
inline double distance_to(const Box& box, const Vec3& point) noexcept {
  return (point - point.cwiseMax(box.low).cwiseMin(box.high)).norm();
}

}  // namespace keepout
