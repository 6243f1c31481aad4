// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/index/query.h"
#include "keepout/mesh/side_of_surface.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"
#include "workspace.h"

namespace keepout {

/// Returns the straight motion of a tip from the forbidden side out through the nearest point of
/// the surface: at most `longest`, and to at most `off` beyond the surface. The depth falls by as
/// much. From the surface itself, or closer to it than `off`, the motion ends at a nearby place
/// that is classified as free; it is zero if there is none. [length]
Vec3 escape_motion(Neighborhood& near, const Vec3& tip, const SideOfSurface& side, double longest,
                   double off) noexcept;

/// Returns true if a tip is on the forbidden side. Then `step` becomes its escape instead of the
/// commanded motion, or `inside` with zero motion: if the tip is deeper than options.deepest, if a
/// guide forbids the escape, or with a Jacobian or rows, which no straight escape satisfies.
/// Preconditions: the mesh is watertight; the motion is checked.
bool escape_from_inside(Neighborhood& near, const Motion& motion, const StepOptions& options,
                        Workspace& work, Step& step) noexcept;

/// Returns true if a tip that touches the surface, so that the rule cannot classify it, can move to
/// a nearby place that is classified as free. Then `step` becomes that motion. Preconditions: those
/// of escape_from_inside.
bool escape_from_surface(Neighborhood& near, const Motion& motion, const StepOptions& options,
                         Workspace& work, Step& step) noexcept;

}  // namespace keepout
