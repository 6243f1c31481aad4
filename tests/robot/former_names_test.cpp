// SPDX-License-Identifier: BSD-3-Clause
// Names that version 0.3 changed still compile, with the same meaning. Remove this file with them.
#include "guards.h"
#include "keepout/index/motion_walk.h"
#include "keepout/mesh/doctor.h"
#include "keepout/step/motion_constraint.h"

#pragma GCC diagnostic ignored "-Wdeprecated-declarations"

namespace keepout {
namespace {

TEST(FormerNames, OfAStepAndAProofHaveTheValuesOfTheNewOnes) {
  auto guard = guard_of(mesh_of(make_shape("gear")), psm({Vec3(30, 10, 120), Mat3::Identity()}));
  const std::vector<double> q(static_cast<std::size_t>(guard.instrument().chain().size()), 0.1);
  std::vector<double> increment(q.size(), 0.0);
  increment[2] = 500.0;
  const MotionProof proof = guard.prove(q, increment);
  EXPECT_EQ(proof.share, proof.fraction);
  const InstrumentStep step = guard.step(q, {.linear = Vec3(0, 0, -0.1)});
  EXPECT_EQ(step.share, step.fraction);
  EXPECT_EQ(step.level, step.clearance_fraction);
  EXPECT_EQ(guard.looks(), guard.work_units());
}

TEST(FormerNames, OfStatusesAndOptionsAreAliases) {
  static_assert(Status::fallback == Status::truncated && Status::yielding == Status::degraded);
  static_assert(Inside::led_out == Inside::escape);
  static_assert(CertifiedMotion::linearised == CertifiedMotion::linearized);
  static_assert(std::is_same_v<MotionWalk, MotionTraversal>);
  InstrumentCapacity capacity;
  capacity.looks = 1;
  auto guard = guard_of(mesh_of(make_shape("gear")), free_ball(1.0), {}, capacity);
  EXPECT_EQ(guard.step(std::vector<double>{0.0, 0.0, 30.0}, {.linear = Vec3(0, 0, -0.1)}).status,
            Status::out_of_budget);
}

}  // namespace
}  // namespace keepout
