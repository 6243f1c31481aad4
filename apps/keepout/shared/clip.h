// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/error.h"
#include "keepout/geometry/shapes.h"

namespace keepout::app {

/// Returns the increment, shortened to at most `longest`. [mm]
inline Vec3 clipped(const Vec3& increment, double longest) {
  const double length = increment.norm();
  return length > longest ? Vec3(increment * (longest / length)) : increment;
}

/// Throws Error if an increment of length `max_step` could leave the motion sphere. [mm]
inline void require_within_reach(double max_step, double radius) {
  if (max_step > radius) {
    throw Error(
        "--max-step is longer than --radius: no step may leave the motion sphere; lower --max-step "
        "or raise --radius");
  }
}

}  // namespace keepout::app
