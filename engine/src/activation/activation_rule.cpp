// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/activation_rule.h"

#include "keepout/activation/planes.h"

namespace keepout {

Ball searched_ends(const RuleInput& input) noexcept {
  if (input.searched_region == EndRegion::motion_sphere) return {input.tip, input.longest};
  // The projections of the target on convex sets that contain 0 lie in the ball over it (Thales).
  return {input.tip + 0.5 * input.target, 0.5 * input.target.norm()};
}

Ball ActivationRule::region(const RuleInput& input) const noexcept {
  Ball ball = searched_ends(input);
  ball.radius += input.clearance;
  return ball;
}

bool ActivationRule::gather(const RuleInput& input) noexcept {
  return neighborhood_->gather(region(input));
}

Judgement ActivationRule::judge(const RuleInput& input, const Vec3& trial,
                                HalfSpaceBuffer& planes) noexcept {
  using Verdict = Judgement::Verdict;
  if (satisfies(trial, planes.view(), input.rounding)) return {Verdict::accepted, 1.0};
  return {Verdict::blocked, 0.0};
}

}  // namespace keepout
