// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/vec3.h"
#include "keepout/ids.h"

namespace keepout {

/// The motions that one plane allows: all d with normal . d >= offset. The plane is placed relative
/// to the tip, so `offset` <= 0 means that standing still is allowed.
struct HalfSpace {
  Vec3 normal;        // unit, towards the free side
  double offset;      // [length]
  TriangleId source;  // the triangle that called for it; no_triangle if none did
};

}  // namespace keepout
