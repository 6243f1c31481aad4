// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/activation/activation_rule.h"
#include "keepout/status.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"

namespace keepout {

/// Throws Error for options out of range, and for a radius that is lost in rounding.
void require_in_range(const StepOptions& options);

/// invalid_input or beyond_reach for a motion that must not be attempted; free otherwise.
/// Precondition: the options are in range.
Status check(const Motion& motion, const StepOptions& options) noexcept;

/// What a position may be off by after a step: the rounding of tip + motion, some 1e-16 of the
/// tip's coordinates, and the solver's, some 1e-13 of the motion; both taken a thousand times.
/// [length]
inline double position_rounding(const Vec3& tip, const StepOptions& options) noexcept {
  return 1e-12 * (tip.lpNorm<1>() + required_clearance(options)) + 1e-10 * options.radius;
}

/// What the rule is to be asked about a motion. `projections`: how far the rule's motions can lead
/// when they are projections of the target.
CycleProblem cycle_problem_of(const Motion& motion, const StepOptions& options,
                              EndRegion projections) noexcept;

}  // namespace keepout
