// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/vec3.h"

namespace keepout {

/// All points within `radius` of `center`, the boundary included. The paper's motion sphere is one:
/// it holds every place that the tip can reach in one control cycle.
struct Ball {
  Vec3 center;    // [length]
  double radius;  // [length], >= 0
};

}  // namespace keepout
