// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/cycle_status.h"

#include <array>

namespace keepout {
namespace {

/// Name and reason of each CycleStatus, in its order.
constexpr std::array<std::array<std::string_view, 2>, 13> outcomes{{
    {"guarded", "the proxy followed as far as the mesh allows"},
    {"not_engaged", "not engaged; call engage()"},
    {"invalid_pose",
     "a number is not finite, or a matrix is not a rotation; check the message that it came from"},
    {"too_far", "the goal is too far from the proxy; check its unit, or engage anew after a jump"},
    {"stale", "no recent goal; check the connection, the rate and the clock of the sender"},
    {"lagging", "the robot is too far from the setpoint; wait for it, or check what blocks it"},
    {"far_from_mesh",
     "the tip is implausibly far from the mesh; check the registration and its units"},
    {"stopped", "the engine refused the step; see its status"},
    {"not_ready", "the robot is not enabled and homed; enable and home it, then engage"},
    {"unmeasured",
     "no recent state of the robot: its setpoint at engage(), later its measured state; check its "
     "connection, rate and clock"},
    {"other_frame",
     "a message is in another frame than the registration; convert it, or register that frame"},
    {"contested", "somebody else commands the robot; stop that program, or do not start this one"},
    {"wrong_command",
     "the session does not take this command, or it has other joints; see its robot"},
}};

std::string_view text_of(CycleStatus status, std::size_t column) noexcept {
  const auto at = static_cast<std::size_t>(status);
  return at < outcomes.size() ? outcomes[at][column] : "unknown";
}

}  // namespace

std::string_view name(CycleStatus status) noexcept { return text_of(status, 0); }

std::string_view reason(CycleStatus status) noexcept { return text_of(status, 1); }

}  // namespace keepout
