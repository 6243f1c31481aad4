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

/// Returns the status that rejects a request, invalid_input or beyond_reach; nothing if the request
/// is valid. Precondition: the options are in range.
std::optional<Status> refusal(const Motion& request, const StepOptions& options) noexcept;

/// Returns a bound of a position's error after a step. The first part is the rounding of tip +
/// motion, about 1e-16 of the tip's coordinates, times ten thousand for safety. The second is the
/// solver's error, about 1e-13 of the motion, times a thousand. [length]
inline double position_rounding(const Vec3& tip, const StepOptions& options) noexcept {
  return 1e-12 * (tip.lpNorm<1>() + required_clearance(options)) + 1e-10 * options.radius;
}

/// Returns the region in which the cycle must keep the ends of motions for a request. It is the
/// motion sphere, or the smaller region that the rule needs. `rule_region`:
/// ActivationRule::end_region().
EndRegion end_region_of(const Motion& request, EndRegion rule_region) noexcept;

/// Returns the input of the rule for a request, whose target is the desired increment.
/// `rule_region`: as for end_region_of().
RuleInput rule_input_of(const Motion& request, const StepOptions& options,
                        EndRegion rule_region) noexcept;

}  // namespace keepout
