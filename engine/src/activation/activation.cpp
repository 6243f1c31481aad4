// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/activation.h"

#include "keepout/activation/planes.h"

namespace keepout {

Ball ends_of_motions(const Surroundings& around) noexcept {
  if (around.searched == Reach::sphere) return {around.tip, around.longest};
  // Projections of the aim on a convex set that holds 0 lie in the ball over it (Thales).
  return {around.tip + 0.5 * around.aim, 0.5 * around.aim.norm()};
}

Ball Activation::region(const Surroundings& around) const noexcept {
  Ball ball = ends_of_motions(around);
  ball.radius += around.margin;
  return ball;
}

bool Activation::look_around(const Surroundings& around) noexcept {
  return near_->look(region(around));
}

Judgement Activation::judge(const Surroundings& around, const Vec3& trial,
                            HalfSpaceBuffer& planes) noexcept {
  using Verdict = Judgement::Verdict;
  if (satisfies(trial, planes.view(), around.rounding)) return {Verdict::accepted, 1.0};
  return {Verdict::blocked, 0.0};
}

}  // namespace keepout
