// SPDX-License-Identifier: BSD-3-Clause
#include "increment_box.h"

#include <algorithm>
#include <cmath>

namespace keepout {

IncrementBox::IncrementBox(const CycleMemory& memory, double period,
                           std::span<const double> q) noexcept
    : memory_(memory), q_(q) {
  const Chain& chain = memory.instrument.chain();
  for (int k = 1; k <= chain.size(); ++k) {
    const auto i = static_cast<std::size_t>(k - 1);
    const JointLimits& limits = chain.joint(k).limits;
    const double most = std::min(limits.velocity * period, limits.increment);
    low_[i] = std::min(std::max(limits.lower - q[i], -most), 0.0);
    high_[i] = std::max(std::min(limits.upper - q[i], most), 0.0);
    is_low_a_position_[i] = limits.lower - q[i] > -most;
    is_high_a_position_[i] = limits.upper - q[i] < most;
    starts_outside_ = starts_outside_ || q[i] < limits.lower || q[i] > limits.upper;
  }
}

bool IncrementBox::clip(JointVector& increment) const noexcept {
  const Chain& chain = memory_.instrument.chain();
  bool is_too_far = false;
  for (int k = 1; k <= chain.size(); ++k) {
    const auto i = static_cast<std::size_t>(k - 1);
    const double lower = std::max(chain.joint(k).limits.lower, -memory_.farthest(k));
    const double upper = std::min(chain.joint(k).limits.upper, memory_.farthest(k));
    double& step = increment[i];
    step = std::clamp(step, low_[i], high_[i]);
    const double there = q_[i] + step;
    if (lower <= there && there <= upper) continue;
    is_too_far = is_too_far || (step > 0.0 && there > memory_.farthest(k)) ||
                 (step < 0.0 && there < -memory_.farthest(k));
    // Where the sum rounds to beyond a limit it is shortened by the excess, which is known exactly,
    // or by a last digit where that is lost.
    for (int again = 0; again < 4; ++again) {
      const double beyond = std::max(q_[i] + step - upper, lower - (q_[i] + step));
      const bool is_towards = step > 0.0 ? q_[i] + step > upper : q_[i] + step < lower;
      if (!(beyond > 0.0) || !is_towards || step == 0.0) break;
      const double shorter = std::min(std::abs(step) - beyond, std::nextafter(std::abs(step), 0.0));
      step = std::copysign(std::max(shorter, 0.0), step);
    }
  }
  return is_too_far;
}

}  // namespace keepout
