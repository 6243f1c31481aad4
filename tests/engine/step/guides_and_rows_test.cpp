// SPDX-License-Identifier: BSD-3-Clause
// Guidance constraints together with the caller's own rows, some of which require motion.
#include <gtest/gtest.h>

#include "guards.h"
#include "keepout/fixtures/random.h"
#include "stub_solver.h"
#include "trials.h"

namespace keepout {
namespace {

// With so narrow a band, the planes of the rounds do not keep the tip in its region. A part of the
// motion would, but it would not satisfy a row that requires motion.
TEST(GuidesAndRows, AStepThatIsOkSatisfiesTheRows) {
  auto guard = guard_of(mesh_of("cube"), {.radius = 5.0, .margin = 0.2});
  Random random(8);
  int ok = 0;
  for (int i = 0; i < test::trials(300); ++i) {
    const Vec3 tip(0, 0, 150);
    const double size = random.uniform(1.0, 3.0);
    const Vec3 out = random.direction();
    guard.set_guides(
        {Guide::point("ball", Region::ball(tip - 0.999 * size * out, size)).with_band(1e-12)});
    const Vec3 row = random.direction();
    const double bound = random.uniform(0.01, 0.5);
    const Step step = guard.step({.tip = tip,
                                  .desired = random.uniform(0.5, 3.0) * random.direction(),
                                  .rows = ExtraRows(row.data(), &bound, 1)});
    ASSERT_TRUE(step.ok() || step.motion.isZero(0.0));
    if (!step.ok()) continue;
    ASSERT_GE(row.dot(step.motion), bound - 1e-9) << name(step.status);
    ++ok;
  }
  EXPECT_GT(ok, test::trials(50));
}

// The solver ignores all rows. Its motion satisfies the caller's row but leaves the guide; the part
// that stays in the guide breaks the row.
TEST(GuidesAndRows, NoPartOfATrialIsExecutedThatBreaksARow) {
  auto guard = guard_of(mesh_of("cube"), {.radius = 5.0, .margin = 0.2}, liar());
  const Vec3 tip(0, 0, 150);
  const Mat3 identity = Mat3::Identity();
  guard.set_guides({Guide::point("ball", Region::ball(tip, 1.0))});
  Random random(9);
  for (int i = 0; i < test::trials(100); ++i) {
    const Vec3 desired = random.uniform(2.0, 4.0) * random.direction();
    const double bound = 0.9 * desired.squaredNorm();
    // With a Jacobian no projection corrects the solver's answer.
    Motion motion{.tip = tip, .desired = desired, .jacobian = identity};
    ASSERT_EQ(guard.step(motion).status, Status::fallback) << "without a row a part is executed";
    motion.rows = ExtraRows(desired.data(), &bound, 1);
    const Step step = guard.step(motion);
    ASSERT_FALSE(step.ok()) << name(step.status);
    ASSERT_TRUE(step.motion.isZero(0.0));
  }
}

}  // namespace
}  // namespace keepout
