// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "keepout/activation/activation_rule.h"
#include "keepout/status.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"

namespace keepout {

/// Throws Error for options out of range, and for a radius that is lost in rounding.
void require_in_range(const StepOptions& options);

/// Returns why a request must not be attempted: invalid_input or beyond_reach. Returns nothing if
/// it may be. Precondition: the options are in range.
std::optional<Status> refusal(const Motion& request, const StepOptions& options) noexcept;

/// Adds the limit that a failure with this status stands for, if there is one.
void add_cause(Status status, Limits& limits) noexcept;

/// Returns a bound of a position's error after a step: the rounding of tip + motion, about 1e-16 of
/// the tip's coordinates, taken ten thousand times, and the solver's, about 1e-13 of the motion,
/// taken a thousand times. [length]
inline double position_rounding(const Vec3& tip, const StepOptions& options) noexcept {
  return 1e-12 * (tip.lpNorm<1>() + required_clearance(options)) + 1e-10 * options.radius;
}

/// Returns the input of the rule for a request. `rule_region`: the rule's
/// ActivationRule::end_region().
CycleProblem cycle_problem_of(const Motion& request, const StepOptions& options,
                              EndRegion rule_region) noexcept;

}  // namespace keepout
