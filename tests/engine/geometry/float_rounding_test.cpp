// SPDX-License-Identifier: BSD-3-Clause
//
// Float filters rely on a tip being the sum of two floats. GCC 12 once dropped the second float.
#include <gtest/gtest.h>

#include "index/wide_bvh/traversal/filters.h"
#include "keepout/fixtures/random.h"

namespace keepout {
namespace {

TEST(FloatRounding, ATipIsTheSumOfItsTwoFloats) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 tip = 100.0 * random.direction();
    const FloatTip split = float_tip(tip);
    for (int axis = 0; axis < 3; ++axis) {
      const double sum = double{split.high[axis]} + double{split.low[axis]};
      EXPECT_NEAR(sum, tip[axis], 1e-13 * 100.0);
    }
  }
}

}  // namespace
}  // namespace keepout
