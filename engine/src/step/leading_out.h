// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/index/query.h"
#include "keepout/mesh/side_of_surface.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"
#include "workspace.h"

namespace keepout {

/// A cycle's way from the forbidden side out through the nearest point of the surface, straight: at
/// most `longest`, and no farther than to `off` the surface. The depth falls by as much. From the
/// surface itself, or closer to it than `off`: as short a way to a place that is found to be free,
/// or none. [length]
Vec3 lead_out(Neighborhood& near, const Vec3& tip, const SideOfSurface& side, double longest,
              double off) noexcept;

/// Whether a tip is on the forbidden side; then `step` becomes the one that leads it out, in place
/// of the one asked for. It is `inside`, with zero motion, when the tip is deeper than
/// options.deepest, if a guide forbids the way out, and with a Jacobian or rows, as there is no
/// straight way out then. Preconditions:
/// the mesh is watertight; the motion is checked.
bool lead_out_from_inside(Neighborhood& near, const Motion& motion, const StepOptions& options,
                          Workspace& work, Step& step) noexcept;

/// Whether there is a short way to a place that is found to be free, for a tip that touches the
/// surface, so that the rule cannot tell its side; then `step` becomes that. The same
/// preconditions.
bool lead_off_surface(Neighborhood& near, const Motion& motion, const StepOptions& options,
                      Workspace& work, Step& step) noexcept;

}  // namespace keepout
