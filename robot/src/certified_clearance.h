// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "keepout/activation/tolerances.h"

namespace keepout {

/// Returns the clearance that a cycle certifies for a body at `distance` from a mesh, or for a
/// guide that is `distance` inside its region. That is `target` if the distance reaches it.
/// Otherwise it is at least `certified`, the clearance of the last cycle, and leaves `room` to a
/// motion. If something else has moved the body or the mesh, it is the distance less the room.
inline double certified_clearance(double distance, double certified, double target, double room,
                                  double tolerance) noexcept {
  if (distance >= target - lost_below * tolerance) return target;
  const double held = std::min(certified, target);
  const double missing = held - distance;
  if (missing > moved_beyond * tolerance) return distance - room;
  return std::min(std::max(held, distance - room), target);
}

}  // namespace keepout
