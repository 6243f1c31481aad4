// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/index/query.h"
#include "keepout/mesh/side_of_surface.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"
#include "workspace.h"

namespace keepout {

/// Returns the straight escape of a tip from the forbidden side towards the nearest point of the
/// surface, at most `longest` long. An escape that can get through ends `clear_by` beyond the
/// surface, at a place that is classified as free; if no such place is found, on the surface. Any
/// other stops short of the surface. (On the free side it leads away from the surface.) [length]
Vec3 escape_motion(Neighborhood& near, const Vec3& tip, const SideOfSurface& side, double longest,
                   double clear_by) noexcept;

/// Classifies a tip. Returns true if that decides the step. Then `step` is the escape of a tip on
/// the forbidden side; `inside` with zero motion if the tip is deeper than options.deepest, if a
/// guide forbids the escape, or with a Jacobian or rows, which no straight escape satisfies; or a
/// failure if budget or capacity did not suffice to classify the tip. Preconditions: the mesh is
/// watertight; the request is not refused.
bool escape_if_inside(Neighborhood& near, const Motion& request, const StepOptions& options,
                      Workspace& work, Step& step) noexcept;

/// Returns true if a tip that touches the surface, so that the rule cannot classify it, can move to
/// a nearby place that is classified as free. Then `step` becomes that motion. Preconditions: those
/// of escape_if_inside.
bool escape_from_surface(Neighborhood& near, const Motion& request, const StepOptions& options,
                         Workspace& work, Step& step) noexcept;

}  // namespace keepout
