// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace keepout {

/// How a step ended. The first five come with a motion, which may be carried out and may be zero;
/// the others with zero motion.
enum class Status : std::uint8_t {
  free,           // no plane holds the motion back
  limited,        // the motion is the best one that the planes allow
  recovering,     // the tip was too close or inside: the motion leads it out
  fallback,       // only a shorter motion could be proven, within the budget of work
  yielding,       // anatomy comes on faster than can be given way to: less than the margin is kept
  infeasible,     // no motion satisfies all planes: the tip is too close on several sides
  ill_posed,      // the Jacobian lacks full column rank and there is no damping
  invalid_input,  // a number is not finite or out of range
  beyond_reach,   // the motion asked for, or solved, is longer than the motion sphere's radius
  over_capacity,  // more triangles, planes or variables than room was made for
  unsolved,       // nothing could be proven within the budget of work, the cycle's or the solver's
  inside,         // the tip is on the forbidden side, and is not led out
  touching,       // the tip is on the surface, and which side is free cannot be told
  margin_too_small,  // the margin is lost in the rounding of lengths this large
  mesh_changed,      // the index was refit to another mesh, which is not followed yet
};

/// How many there are.
inline constexpr std::size_t status_count = static_cast<std::size_t>(Status::mesh_changed) + 1;

/// A motion comes with it, which may be carried out.
constexpr bool is_ok(Status status) noexcept { return status <= Status::yielding; }

/// The name as it stands in the enumeration, for files and logs.
std::string_view name(Status status) noexcept;

/// One line on what happened and what to do about it.
std::string_view reason(Status status) noexcept;

}  // namespace keepout
