// SPDX-License-Identifier: BSD-3-Clause
// A tip that is too close retreats by at least one tolerance per cycle, even if `recovery` is
// smaller. Otherwise the loss by rounding in one cycle would add up with that of the next.
#include <gtest/gtest.h>

#include "accuracy/certified_loop.h"

namespace keepout::test {
namespace {

TEST(LeastRetreat, IsATolerance) {
  Random random(9);
  for (const double recovery : {0.0, 1e-15, 1e-12}) {
    for (const char* shape : {"cube", "sphere", "gear"}) {
      SCOPED_TRACE(testing::Message() << shape << ", recovery " << recovery);
      Loop loop(make_shape(shape),
                {.options = {.radius = 1.0, .margin = 0.5, .recovery = recovery}});
      for (const Vec3& tip : places(loop, 5, 0.3, random)) {
        const Step step = loop.step(tip, Vec3::Zero());
        ASSERT_EQ(step.status, Status::recovering);
        EXPECT_GE(step.motion.norm(), 0.99 * loop.tolerance(tip));
        EXPECT_GT(loop.distance(tip + step.motion), loop.distance(tip));
      }
    }
  }
}

}  // namespace
}  // namespace keepout::test
