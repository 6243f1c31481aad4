// SPDX-License-Identifier: BSD-3-Clause
// The work budget or the memory of a step runs out at an arbitrary point. Then the step is safe, or
// nothing moves.
#include <gtest/gtest.h>

#include <cstddef>

#include "accuracy/certified_loop.h"
#include "trials.h"

namespace keepout::test {
namespace {

TEST(SpentBudget, NoStepIsUnsafeWhereverTheWorkEnds) {
  Random random(3);
  int moved = 0;
  int stopped = 0;
  for (int trial = 0; trial < trials(50); ++trial) {
    MotionConstraintSettings settings{.options = {.radius = 3.0, .margin = 0.5}};
    settings.capacity.looks = static_cast<std::size_t>(std::exp2(random.uniform(2.0, 16.0)));
    constexpr const char* names[] = {"gear", "cortex", "sphere", "fan"};
    Loop loop(
        trial % 5 == 4 ? make_cone(3000, random.uniform(0.1, 2.0)) : make_shape(names[trial % 5]),
        settings);
    SCOPED_TRACE(testing::Message() << "trial " << trial << ", looks " << settings.capacity.looks);
    for (const Vec3& tip : places(loop, 6, random.uniform(0.05, 0.8), random)) {
      for (int i = 0; i < 6; ++i) {
        const Step step = loop.step(tip, random.uniform(0.1, 3.0) * random.direction());
        stopped += step.ok() ? 0 : 1;
        ASSERT_NO_FATAL_FAILURE(expect_safe(loop, tip, step, moved));
      }
    }
  }
  EXPECT_GT(moved, trials(200));
  EXPECT_GT(stopped, trials(50));
}

// The tip is above a cone of many faces. The budget lasts, but not the memory for prepared
// triangles and for triangles that the traversal defers.
TEST(SpentBudget, NoStepIsUnsafeWhereMoreTrianglesAreNearThanFitInMemory) {
  Random random(4);
  int moved = 0;
  for (const VertexId faces : {3000u, 30000u}) {
    for (const double slope : {0.05, 0.3, 1.0}) {
      MotionConstraintSettings settings{.options = {.radius = 5.0, .margin = 1.0}};
      settings.capacity.looks = std::size_t{1} << 30;
      Loop loop(make_cone(faces, slope), settings);
      SCOPED_TRACE(testing::Message() << faces << " faces, slope " << slope);
      for (int i = 0; i < trials(8); ++i) {
        const Vec3 tip(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3),
                       random.uniform(1.0, 2.0));
        const Vec3 desired(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0),
                           random.uniform(-3.0, -0.1));
        ASSERT_NO_FATAL_FAILURE(expect_safe(loop, tip, loop.step(tip, desired), moved));
      }
    }
  }
  EXPECT_GT(moved, trials(10));
}

}  // namespace
}  // namespace keepout::test
