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

}  // namespace keepout::app
