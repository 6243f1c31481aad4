// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

  /// Takes an increment back into the box.
  void clip(JointVector& increment) const noexcept;

 private:
  const CycleMemory& memory_;
  std::span<const double> q_;
  JointVector low_;
  JointVector high_;
};

}  // namespace keepout
