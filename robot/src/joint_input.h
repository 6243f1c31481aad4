// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "cycle_memory.h"

namespace keepout {

/// Returns free if a cycle may start: poses and speeds of all meshes are valid, indices are
/// current, and q (n) is within CycleMemory::largest_position_of. Otherwise returns the cause.
Status check_start(const CycleMemory& memory, const InstrumentOptions& options,
                   std::span<const double> q) noexcept;

/// Returns true if q and `increment` are of n joints, and all joints stay within
/// CycleMemory::largest_position_of at q (n), moved by `increment` (n).
bool are_positions(const CycleMemory& memory, std::span<const double> q,
                   std::span<const double> increment) noexcept;

/// Returns true if a task of the flange is finite and within bounds.
bool is_task(const Twist& desired) noexcept;

/// Returns true if a task of the joints (n) and its weights (n, or none) are finite and within
/// bounds, and the weights above 0.
bool is_task(std::span<const double> desired, std::span<const double> weights,
             std::size_t joints) noexcept;

/// Returns true if a pose and a velocity of a mesh are valid: see InstrumentConstraint::place.
bool is_placement(const Pose& pose, const Twist& velocity, double largest_position) noexcept;

}  // namespace keepout
