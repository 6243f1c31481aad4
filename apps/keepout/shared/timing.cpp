// SPDX-License-Identifier: BSD-3-Clause
#include "shared/timing.h"

#include <algorithm>
#include <cmath>

namespace keepout::app {

Timing timing_of(std::vector<double>& samples) {
  if (samples.empty()) return {};
  std::sort(samples.begin(), samples.end());
  const auto at = [&](double share) {
    const auto rank = std::ceil(share * static_cast<double>(samples.size()));
    return samples[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
  };
  Timing timing{.p50 = at(0.5), .max = samples.back(), .samples = samples.size()};
  if (samples.size() >= 100) timing.p99 = at(0.99);
  if (samples.size() >= 1000) timing.p999 = at(0.999);
  return timing;
}

void Times::add(double us) {
  constexpr std::size_t most = std::size_t{1} << 20;
  longest_ = std::max(longest_, us);
  if (++count_ % every_ != 0) return;
  kept_.push_back(us);
  if (kept_.size() < most) return;
  for (std::size_t i = 0; i < most / 2; ++i) kept_[i] = kept_[2 * i + 1];
  kept_.resize(most / 2);
  every_ *= 2;
}

Timing Times::timing() const {
  std::vector<double> samples = kept_;
  Timing timing = timing_of(samples);
  timing.max = longest_;
  timing.samples = count_;
  return timing;
}

}  // namespace keepout::app
