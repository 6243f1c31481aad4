// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace keepout {

/// The outcome of a step or a query. The first five come with a motion that may be executed (it may
/// be zero). All others come with zero motion.
enum class Status : std::uint8_t {
  free,              // the motion is the desired increment; or a polytope is complete
  limited,           // the nearest motion that the constraints allow: see Limits
  recovering,        // a tip or body too close, or a guided point outside its region, recovers
  truncated,         // a shorter motion, as no longer motion was proved: see Limits
  degraded,          // instruments only: a mesh approaches too fast to maintain the clearance
  infeasible,        // the constraints contradict each other
  ill_posed,         // the Jacobian lacks full column rank and there is no damping
  invalid_input,     // a number is not finite or out of range
  beyond_reach,      // the desired increment is longer than the radius of the motion sphere
  over_capacity,     // more triangles, planes, rows or joints than the capacity holds
  unsolved,          // the search ended without a motion that could be proved
  inside,            // the tip or a body is on the forbidden side, and does not escape
  touching,          // the tip or a body is on the surface: the free side is unknown
  margin_too_small,  // rounding hides the margin or band, as lengths are too large
  mesh_changed,      // the index was refit, and the constraint does not follow the new mesh yet
  out_of_budget,     // the work budget of the cycle ended before a motion was proved
  unsupported,       // polytopes only: the rule guards a tool, or there are guides
  unconfirmed,       // the monitor did not confirm the motion: it disagrees, or could not decide
  // Names before version 0.3.
  fallback [[deprecated("use truncated")]] = truncated,
  yielding [[deprecated("use degraded")]] = degraded,
};

/// Number of statuses.
inline constexpr std::size_t status_count = static_cast<std::size_t>(Status::unconfirmed) + 1;

/// The subject of a step or query, named in reasons.
enum class Subject : std::uint8_t { tip, instrument, polytope };

/// Returns true if the status comes with a motion that may be executed.
constexpr bool is_ok(Status status) noexcept { return status <= Status::degraded; }

/// Returns the name of the enumerator, for files and logs.
std::string_view name(Status status) noexcept;

/// Returns one line on what happened and what to do about it.
std::string_view reason(Status status, Subject subject) noexcept;

/// A cause that makes a motion differ from the desired one, or a related finding.
enum class Limit : std::uint8_t {
  mesh,            // the required clearance from a mesh
  guide,           // a guide: see GuideState
  joint_position,  // a position limit of a joint
  joint_velocity,  // a velocity or increment limit of a joint
  rows,            // the caller's own rows
  radius,          // the radius of the motion sphere, or in a recovery twice the retreat
  linearization,   // the true joint motion is far from the linear one, or worse than zero motion
  budget,          // the work budget of the cycle ended
  capacity,        // a buffer was too small
  truncated,       // only a part of a motion was proved, or a motion towards a nearer target
  joints_outside,  // a joint starts outside its position limits; it may stay or return
  singularity,     // in this pose the damped joints make less than half of the motion
};

/// Number of limits.
inline constexpr std::size_t limit_count = static_cast<std::size_t>(Limit::singularity) + 1;

/// Returns the name of the enumerator, for files and logs.
std::string_view name(Limit limit) noexcept;

/// A set of limits.
class Limits {
 public:
  /// Adds a limit.
  constexpr void add(Limit limit) noexcept { bits_ |= bit(limit); }
  /// Adds all limits of another set.
  constexpr void add(const Limits& others) noexcept { bits_ |= others.bits_; }
  /// Returns true if the set contains a limit.
  constexpr bool has(Limit limit) const noexcept { return (bits_ & bit(limit)) != 0; }
  /// Returns true if the set is empty.
  constexpr bool empty() const noexcept { return bits_ == 0; }
  /// Returns the set as bits: bit i is limit i.
  constexpr std::uint16_t bits() const noexcept { return bits_; }
  /// Returns true if both sets are equal.
  constexpr bool operator==(const Limits&) const noexcept = default;

 private:
  static constexpr std::uint16_t bit(Limit limit) noexcept {
    return static_cast<std::uint16_t>(1u << static_cast<unsigned>(limit));
  }
  std::uint16_t bits_ = 0;
};

}  // namespace keepout
