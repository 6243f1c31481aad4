// SPDX-License-Identifier: BSD-3-Clause
// The step checks the answers of a rule that contradicts itself.
#include <gtest/gtest.h>

#include "guards.h"

namespace keepout {
namespace {

/// Rejects every motion, and yet reports that the whole of it is free.
class Boaster final : public ActivationRule {
 public:
  Opening open(const RuleInput&, HalfSpaceBuffer&) noexcept override { return {}; }
  Judgement judge(const RuleInput&, const Vec3& trial, HalfSpaceBuffer&) noexcept override {
    if (trial.isZero(0.0)) return {Judgement::Verdict::accepted};
    return {Judgement::Verdict::blocked, 1.0};
  }
};

TEST(UntrustedRule, NoPartOfATrialIsMadeThatTheRuleRejects) {
  auto guard = guard_of(mesh_of("cube"), {.radius = 5.0, .margin = 0.0},
                        std::make_unique<ActiveSet>(), std::make_unique<Boaster>());
  const Step step = guard.step({.tip = Vec3(0, 0, 60), .desired = Vec3(0, 0, -1)});
  EXPECT_FALSE(step.ok());
  EXPECT_EQ(step.motion, Vec3::Zero());
  EXPECT_TRUE(step.increment.empty());
}

}  // namespace
}  // namespace keepout
