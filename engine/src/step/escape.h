// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "keepout/index/query.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"
#include "tip_memory.h"

namespace keepout {

/// Returns the straight escape of a tip from the forbidden side towards the nearest point of the
/// surface, at most `longest` long. An escape that can get through ends `clear_by` beyond the
/// surface, at a place that is classified as free; if no such place is found, on the surface. Any
/// other stops short of the surface. (On the free side it leads away from the surface.) [length]
Vec3 escape_motion(Neighborhood& neighborhood, const Vec3& tip, const SideOfSurface& side,
                   double longest, double clear_by) noexcept;

/// Classifies a tip. Returns the whole step if the classification decides it: the escape of a tip
/// on the forbidden side; `inside` with zero motion if the tip is deeper than options.deepest, if a
/// guide forbids the escape, or with a Jacobian or rows, which no straight escape satisfies; or a
/// failure if budget or capacity did not suffice to classify the tip. Returns nothing for a tip on
/// the free side. Preconditions: the mesh is watertight; the request is not refused.
std::optional<Step> step_of_tip_inside(Neighborhood& neighborhood, const Motion& request,
                                       const StepOptions& options, TipMemory& memory) noexcept;

/// Returns the escape of a tip that touches the surface, so that the rule cannot find its side, to
/// a nearby place that is classified as free. Returns nothing if there is no such place.
/// Preconditions: those of step_of_tip_inside.
std::optional<Step> escape_from_surface(Neighborhood& neighborhood, const Motion& request,
                                        const StepOptions& options, TipMemory& memory) noexcept;

}  // namespace keepout
