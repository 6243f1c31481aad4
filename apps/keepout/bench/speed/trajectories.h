// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "bench/speed/guarded_mesh.h"
#include "keepout/fixtures/motions.h"
#include "keepout/fixtures/random.h"

namespace keepout::app {

// What hands ask of a tool. Each throws Error where the mesh has hardly any room for such motions.

/// A hand that presses a tool against the surface and drags it along in strokes of 50 cycles, and
/// the certified rule that keeps it `kind.clearance` off: the tip goes where the step leads it, as
/// in a control loop. Only cycles in which the tool is held back are handed on.
std::vector<Motion> pressed_motions(const IndexedMesh& on, std::size_t count,
                                    const MotionKind& kind, Random random);

/// How far from the surface a tool is led. [length]
struct FreeSpace {
  double nearest = 2.0;
  double farthest = 20.0;
};

/// A hand that leads a tool through free space, on a smooth path, cycle after cycle: nothing holds
/// it back. The lengths of the increments are those of `kind`.
std::vector<Motion> free_motions(const IndexedMesh& on, std::size_t count, const FreeSpace& space,
                                 const MotionKind& kind, Random random);

/// All over the surface, as a planner asks, and only where it holds the motion back under the
/// certified rule: elsewhere there is hardly anything to time.
std::vector<Motion> held_back_motions(const IndexedMesh& on, std::size_t count,
                                      const MotionKind& kind, Random random);

/// Back and forth around the origin: in a sphere around it all triangles are equally far.
std::vector<Motion> central_motions(std::size_t count, const MotionKind& kind, Random random);

}  // namespace keepout::app
