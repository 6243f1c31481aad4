// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "keepout/robot/chain.h"
#include "keepout/status.h"
#include "point_motion.h"

namespace keepout {

/// The bounds of the joints' positions and increments in a cycle: low <= dq <= high, and the
/// computed q + dq is within the position limits.
class IncrementBox {
 public:
  /// Returns the largest distance of joint k (1..n) from 0 that a cycle accepts, so that rounding
  /// stays small: sixteen turns, or `largest_length` of a prismatic joint. [rad or length]
  static double largest_position(const Chain& chain, int k, double largest_length) noexcept {
    return chain.joint(k).kind == JointKind::prismatic ? largest_length : 100.0;
  }

  /// Makes the bounds of a cycle of `period` seconds that starts at q (n). Chain and q must outlive
  /// this object.
  IncrementBox(const Chain& chain, double largest_length, double period,
               std::span<const double> q) noexcept;

  /// Returns the least increments (n), at most 0: a joint beyond a limit may stay or return.
  const JointVector& low() const noexcept { return low_; }
  /// Returns the largest increments (n), at least 0.
  const JointVector& high() const noexcept { return high_; }

  /// Returns the kind of limit that bounds the increment of joint k (1..n), upwards or downwards.
  Limit limit(int k, bool upwards) const noexcept {
    const auto& is_position = upwards ? is_high_a_position_ : is_low_a_position_;
    return is_position[static_cast<std::size_t>(k - 1)] ? Limit::joint_position
                                                        : Limit::joint_velocity;
  }
  /// Returns true if a joint starts outside its position limits.
  bool starts_outside() const noexcept { return starts_outside_; }

  /// Clips an increment to the box. Returns true if a joint without limits would have moved beyond
  /// largest_position(), which is a position limit too.
  bool clip(JointVector& increment) const noexcept;

 private:
  const Chain& chain_;
  double largest_length_;
  std::span<const double> q_;
  JointVector low_;
  JointVector high_;
  std::array<bool, Chain::most_joints> is_low_a_position_{};
  std::array<bool, Chain::most_joints> is_high_a_position_{};
  bool starts_outside_ = false;
};

}  // namespace keepout
