// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/vec3.h"

namespace keepout {

/// An axis-aligned box. [length]
struct Box {
  Vec3 low;
  Vec3 high;

  Vec3 center() const noexcept { return 0.5 * (low + high); }
  Vec3 size() const noexcept { return high - low; }
};

}  // namespace keepout
