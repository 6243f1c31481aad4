// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "bench/speed/indexed_mesh.h"
#include "keepout/fixtures/motions.h"
#include "keepout/fixtures/random.h"
#include "keepout/step/motion.h"

namespace keepout::app {

/// A hand that presses a tool against the surface and drags it along in strokes of 50 cycles, and
/// the certified rule that keeps it `kind.clearance` off: the tip goes where the step leads it, as
/// in a control loop. Only cycles in which the tool is held back are handed on. Throws Error where
/// the mesh has hardly any room for such a tip.
std::vector<Motion> pressed_motions(const IndexedMesh& on, std::size_t count,
                                    const MotionKind& kind, Random& random);

}  // namespace keepout::app
