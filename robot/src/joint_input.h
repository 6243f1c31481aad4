// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "cycle_memory.h"
#include "increment_box.h"

namespace keepout {

/// Returns free if a cycle may start: poses and speeds of all meshes are valid, indices are
/// current, margins exceed rounding, and q (n) is within IncrementBox::largest_position. Otherwise
/// returns the status that states the cause.
Status check_start(const CycleMemory& memory, const InstrumentOptions& options,
                   std::span<const double> q) noexcept;

/// Returns true if q and `increment` both have n elements, and no joint is beyond
/// IncrementBox::largest_position at q + increment.
bool are_valid_positions(const CycleMemory& memory, std::span<const double> q,
                         std::span<const double> increment) noexcept;

/// Returns true if a task of the flange is finite and within bounds.
bool is_valid_task(const Twist& displacement) noexcept;

/// Returns true if a task of the joints (n) and its weights (n, or empty) are finite and within
/// bounds, and the weights are above 0.
bool is_valid_task(std::span<const double> desired, std::span<const double> weights,
                   std::size_t joints) noexcept;

/// Returns true if a pose and a velocity of a mesh are valid: see InstrumentConstraint::place.
bool is_valid_placement(const Pose& pose, const Twist& velocity, double largest_length) noexcept;

}  // namespace keepout
