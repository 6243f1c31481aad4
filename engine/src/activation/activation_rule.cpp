// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/activation_rule.h"

#include "keepout/activation/planes.h"

namespace keepout {

Ball searched_ends(const CycleProblem& problem) noexcept {
  if (problem.searched_region == EndRegion::motion_sphere) return {problem.tip, problem.longest};
  // Projections of the target on a convex set that holds 0 lie in the ball over it (Thales).
  return {problem.tip + 0.5 * problem.target, 0.5 * problem.target.norm()};
}

Ball ActivationRule::region(const CycleProblem& problem) const noexcept {
  Ball ball = searched_ends(problem);
  ball.radius += problem.clearance;
  return ball;
}

bool ActivationRule::gather(const CycleProblem& problem) noexcept {
  return near_->gather(region(problem));
}

Judgement ActivationRule::judge(const CycleProblem& problem, const Vec3& trial,
                                HalfSpaceBuffer& planes) noexcept {
  using Verdict = Judgement::Verdict;
  if (satisfies(trial, planes.view(), problem.rounding)) return {Verdict::accepted, 1.0};
  return {Verdict::blocked, 0.0};
}

}  // namespace keepout
