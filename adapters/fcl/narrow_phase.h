// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "keepout/geometry/narrow_phase.h"

namespace keepout {

// Both are asked about the tool's core, whose radius is taken off afterwards: GJK is at its best on
// corners.

/// libccd's GJK and EPA as FCL has rewritten them.
std::unique_ptr<NarrowPhase> make_fcl_gjk_libccd(const ConvexTool& tool);

/// FCL's other pair, after Bullet.
std::unique_ptr<NarrowPhase> make_fcl_gjk_indep(const ConvexTool& tool);

std::string fcl_narrow_phase_library();

}  // namespace keepout
