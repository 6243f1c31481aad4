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

}  // namespace keepout
