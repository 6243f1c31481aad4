// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/cycle_status.h"

namespace keepout {

std::string_view name(CycleStatus status) noexcept {
  switch (status) {
    case CycleStatus::guarded:
      return "guarded";
    case CycleStatus::not_engaged:
      return "not_engaged";
    case CycleStatus::invalid_pose:
      return "invalid_pose";
    case CycleStatus::too_far:
      return "too_far";
    case CycleStatus::stale:
      return "stale";
    case CycleStatus::lagging:
      return "lagging";
    case CycleStatus::far_from_mesh:
      return "far_from_mesh";
    case CycleStatus::stopped:
      return "stopped";
  }
  return "unknown";
}

std::string_view reason(CycleStatus status) noexcept {
  switch (status) {
    case CycleStatus::guarded:
      return "the proxy followed as far as the mesh allows";
    case CycleStatus::not_engaged:
      return "not engaged; call engage() with where the robot is";
    case CycleStatus::invalid_pose:
      return "a pose is not finite, or its rotation is none; check the message that it came from";
    case CycleStatus::too_far:
      return "the goal is too far from the proxy; check its unit, or engage anew after a jump";
    case CycleStatus::stale:
      return "no goal came for too long; check the connection and the rate of the sender";
    case CycleStatus::lagging:
      return "the robot is not where it was sent; wait for it, or look at what holds it";
    case CycleStatus::far_from_mesh:
      return "the tip is implausibly far from the mesh; check the registration and its units";
    case CycleStatus::stopped:
      return "the engine refused the step; see its status";
  }
  return "unknown";
}

}  // namespace keepout
