// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "cycle_memory.h"

namespace keepout {

/// The increments that the limits of the joints allow in a cycle: low <= dq <= high, and q + dq
/// within them to the last bit.
class IncrementBox {
 public:
  /// From q (n), in a cycle of so many seconds. The memory, and q, must outlive it.
  IncrementBox(const CycleMemory& memory, double period, std::span<const double> q) noexcept;

  /// The least increments (n), at most 0: a joint that is beyond a limit may stay, or come back.
  const JointVector& low() const noexcept { return low_; }
  /// The largest, at least 0.
  const JointVector& high() const noexcept { return high_; }

  /// Returns which limit of a joint, counted from 0, bounds its increment upwards or downwards.
  Limit limit(std::size_t joint, bool upwards) const noexcept {
    return (upwards ? is_high_a_position_ : is_low_a_position_)[joint] ? Limit::joint_position
                                                                       : Limit::joint_velocity;
  }
  /// Returns true if a joint starts outside its position limits.
  bool starts_outside() const noexcept { return starts_outside_; }

  /// Takes an increment back into the box. Returns true if a joint without limits would have gone
  /// farther than the next cycle accepts (CycleMemory::farthest), which is a position limit too.
  bool clip(JointVector& increment) const noexcept;

 private:
  const CycleMemory& memory_;
  std::span<const double> q_;
  JointVector low_;
  JointVector high_;
  std::array<bool, Chain::most_joints> is_low_a_position_{};
  std::array<bool, Chain::most_joints> is_high_a_position_{};
  bool starts_outside_ = false;
};

}  // namespace keepout
