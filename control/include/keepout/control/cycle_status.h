// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>

namespace keepout {

/// The outcome of a controller's cycle, or of engage(). With `guarded`, the proxy has moved by the
/// step. With all others, the proxy has not moved.
enum class CycleStatus : std::uint8_t {
  guarded,        // the step was ok: HapticCycle::step and limits have the details
  not_engaged,    // engage() has not set the proxy yet: there is no force
  invalid_pose,   // a number is not finite, or the matrix is not a rotation
  too_far,        // the goal is too far from the proxy: wrong unit, or a jump
  stale,          // no goal arrived for too long, or its stamp is too old
  lagging,        // the robot is too far from its setpoint
  far_from_mesh,  // at engage(): too far from the mesh; check unit and registration
  stopped,        // the step failed: see HapticCycle::step
  not_ready,      // the robot is not enabled, or not homed
  unmeasured,     // no measured state of the robot arrived for too long
  other_frame,    // a message is in another frame than that of the session
  contested,      // somebody else commands the robot, or the session
  wrong_command   // the session does not take this command, or the message has other joints
};

/// Returns true if the proxy has moved by the step.
constexpr bool is_ok(CycleStatus status) noexcept { return status == CycleStatus::guarded; }

/// Returns the name of the enumerator, for logs.
std::string_view name(CycleStatus status) noexcept;

/// Returns one line on what happened and what to do about it.
std::string_view reason(CycleStatus status) noexcept;

}  // namespace keepout
