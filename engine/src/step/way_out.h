// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "keepout/index/neighborhood.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"
#include "workspace.h"

namespace keepout {

/// The step of a tip on the forbidden side, in place of the one asked for; nothing for a tip on the
/// free side. `inside` and zero motion when it is deeper than options.deepest, and with a Jacobian
/// or rows, as there is no straight way out. Preconditions: the mesh is watertight; the motion is
/// checked.
std::optional<Step> step_from_inside(Neighborhood& near, const Motion& motion,
                                     const StepOptions& options, Workspace& work) noexcept;

/// The step of a tip that touches the surface, so that the rule cannot tell its side: a short way
/// to a place that is found to be free. Nothing where none is found, or none may be made. The same
/// preconditions.
std::optional<Step> step_off_surface(Neighborhood& near, const Motion& motion,
                                     const StepOptions& options, Workspace& work) noexcept;

}  // namespace keepout
