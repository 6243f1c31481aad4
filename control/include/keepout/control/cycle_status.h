// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>

namespace keepout {

/// How a cycle of a controller ended. Of the first the proxy has moved as the engine's step says;
/// after any other it stands where it was.
enum class CycleStatus : std::uint8_t {
  guarded,        // the step was ok: see it for whether and how it was limited
  not_engaged,    // engage() has not placed the proxy yet: there is no force either
  invalid_pose,   // a number is not finite, or the rotation is none
  too_far,        // the goal is farther from the proxy than a hand can be: wrong unit, or a jump
  stale,          // there was no goal for too long
  lagging,        // the robot is not where it was sent
  far_from_mesh,  // on engaging: so far from the mesh that unit or registration must be wrong
  stopped         // the engine refused the step: see its status
};

/// Whether the proxy went where the step allowed.
constexpr bool is_ok(CycleStatus status) noexcept { return status == CycleStatus::guarded; }

/// The name as it stands in the enumeration, for logs.
std::string_view name(CycleStatus status) noexcept;

/// One line on what happened and what to do about it.
std::string_view reason(CycleStatus status) noexcept;

}  // namespace keepout
