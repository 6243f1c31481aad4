// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <span>

#include "keepout/fixtures/random.h"
#include "keepout/robot/chain.h"
#include "trials.h"

namespace keepout::test {

/// Returns the frames of a chain at joint positions.
inline ChainState state_of(const Chain& chain, std::span<const double> q) {
  ChainState state;
  chain.forward_kinematics(q, state);
  return state;
}

/// Returns random joint positions within the limits, and within half a turn or 300 mm.
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
