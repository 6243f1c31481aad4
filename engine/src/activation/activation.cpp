// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/activation.h"

#include "keepout/activation/planes.h"

namespace keepout {

Ball Activation::region(const Surroundings& around) const noexcept {
  return {around.tip, around.longest + around.margin};
}

Judgement Activation::judge(const Surroundings& around, const Vec3& trial,
                            HalfSpaceBuffer& planes) noexcept {
  using Verdict = Judgement::Verdict;
  if (satisfies(trial, planes.view(), around.rounding)) return {Verdict::accepted, 1.0};
  return {Verdict::blocked, 0.0};
}

}  // namespace keepout
