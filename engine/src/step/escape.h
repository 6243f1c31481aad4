// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "keepout/index/query.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"
#include "tip_memory.h"

namespace keepout {

/// Returns the straight escape of a tip from the forbidden side towards the nearest point of the
/// surface. It is at most `longest` long. If it can get through the surface, it ends `clear_by`
/// beyond, at a place that is classified as free; without such a place it ends on the surface.
/// Otherwise it stops short of the surface. (A tip on the free side moves away from the surface.)
/// [length]
Vec3 escape_motion(Neighborhood& neighborhood, const Vec3& tip, const SideOfSurface& side,
                   double longest, double clear_by) noexcept;

/// Classifies a tip. Returns the whole step if the classification decides it, and nothing for a tip
/// on the free side. The step of a tip on the forbidden side is its escape. The status is `inside`,
/// with zero motion, if the tip is deeper than options.deepest, or no free place is nearby. It is
/// `inside` also if a guide forbids the escape, and with a Jacobian or rows. The step fails if
/// budget or capacity did not suffice to classify the tip. Preconditions: the mesh is watertight;
/// the request is not refused.
std::optional<Step> step_of_tip_inside(Neighborhood& neighborhood, const Motion& request,
                                       const StepOptions& options, TipMemory& memory) noexcept;

/// Returns the escape of a tip that touches the surface to a nearby place that is classified as
/// free. (The rule cannot find the side of such a tip.) Returns nothing if there is no such place.
/// Preconditions: as for step_of_tip_inside.
std::optional<Step> escape_from_surface(Neighborhood& neighborhood, const Motion& request,
                                        const StepOptions& options, TipMemory& memory) noexcept;

}  // namespace keepout
