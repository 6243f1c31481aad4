// SPDX-License-Identifier: BSD-3-Clause
// The set of triangles near a body is reused from cycle to cycle, while the body is so near to
// where the set was made that the set still has all triangles that the cycle needs.
#include <gtest/gtest.h>

#include "guards.h"

namespace keepout {
namespace {

// The ball is displaced from where its set was made, by 1 % more in each trial. A wall is just near
// enough to forbid the motion after that. For some displacements the set does not have the wall.
TEST(StaleNearSet, IsNotUsedWhereTheBodyHasMovedTooFar) {
  constexpr double radius = 1.0;
  const auto mesh = wall(0.0);
  const InstrumentOptions options{.damping = 0.0};
  const double kept = options.margin - options.band;
  for (const double motion : {0.01, 0.05, 0.1, 0.15}) {
    auto guard = guard_of(mesh, free_ball(radius), options);
    for (double way = 0.01; way < 20.0; way *= 1.01) {
      const double missing = 0.02 * way;
      const double start = way + radius + kept + motion - missing;  // from the wall
      guard.forget();
      std::vector<double> q{start, 0.0, 0.0};
      ASSERT_TRUE(guard.step(q, std::vector<double>(3, 0.0)).ok());
      q[0] -= way;
      if (q[0] < radius + options.margin) continue;
      const InstrumentStep step = guard.step(q, std::vector<double>{-motion, 0.0, 0.0});
      ASSERT_TRUE(step.ok()) << step.reason();
      ASSERT_GE(q[0] + step.increment[0] - radius, kept - 3.0 * guard.tolerance())
          << "after a displacement of " << way << " and a motion of " << motion;
    }
  }
}

}  // namespace
}  // namespace keepout
