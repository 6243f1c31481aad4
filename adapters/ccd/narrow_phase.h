// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "keepout/geometry/narrow_phase.h"

namespace keepout {

// libccd tells the depth of an overlap, and of bodies apart only that they are: their distance is
// asked for as the depth of a tool that is grown by more than it.

std::unique_ptr<NarrowPhase> make_ccd_gjk(const ConvexTool& tool);
std::unique_ptr<NarrowPhase> make_ccd_mpr(const ConvexTool& tool);

std::string ccd_library();

}  // namespace keepout
