// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/robot/chain.h"

namespace keepout::test {

inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// Positions of the joints within their limits, evenly; of joints without, within half a turn.
inline std::vector<double> configuration(const Chain& chain, Random& random) {
  std::vector<double> q;
  for (int k = 1; k <= chain.size(); ++k) {
    const JointLimits& limits = chain.joint(k).limits;
    q.push_back(random.uniform(std::max(limits.lower, -3.2), std::min(limits.upper, 3.2)));
    if (chain.joint(k).kind == JointKind::prismatic) {
      q.back() = random.uniform(std::max(limits.lower, -300.0), std::min(limits.upper, 300.0));
    }
  }
  return q;
}

}  // namespace keepout::test
