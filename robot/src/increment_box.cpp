// SPDX-License-Identifier: BSD-3-Clause
#include "increment_box.h"

#include <algorithm>
#include <cmath>

namespace keepout {

IncrementBox::IncrementBox(const Chain& chain, double largest_length, double period,
                           std::span<const double> q) noexcept
    : chain_(chain), largest_length_(largest_length), q_(q) {
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
  bool is_too_far = false;
  for (int k = 1; k <= chain_.size(); ++k) {
    const auto i = static_cast<std::size_t>(k - 1);
    const double most = largest_position(chain_, k, largest_length_);
    const double lower = std::max(chain_.joint(k).limits.lower, -most);
    const double upper = std::min(chain_.joint(k).limits.upper, most);
    double& step = increment[i];
    step = std::clamp(step, low_[i], high_[i]);
    const double there = q_[i] + step;
    if (lower <= there && there <= upper) continue;
    is_too_far = is_too_far || (step > 0.0 && there > most) || (step < 0.0 && there < -most);
    // The rounded sum is beyond a limit. The excess is exact, so it shortens the step; if the
    // excess is lost in rounding, one ulp does.
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
