// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "keepout/activation/tolerances.h"

namespace keepout {

/// Returns the certified clearance F of a cycle (docs/joint-space-step.md, "Certified clearance"),
/// for a body at `distance` from a mesh, or for a guide that is `distance` inside its region. F is
/// `target` if the distance reaches it. Otherwise F is the larger of `certified`, the F of the last
/// cycle, and distance - room, but at most `target`. If something other than a step has moved the
/// body or the mesh, F is distance - room.
inline double certified_clearance(double distance, double certified, double target, double room,
                                  double tolerance) noexcept {
  if (distance >= target - lost_below * tolerance) return target;
  const double held = std::min(certified, target);
  const double missing = held - distance;
  if (missing > moved_beyond * tolerance) return distance - room;
  return std::min(std::max(held, distance - room), target);
}

}  // namespace keepout
