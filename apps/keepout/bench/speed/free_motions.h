// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "keepout/fixtures/motions.h"
#include "keepout/fixtures/random.h"
#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout::app {

/// How far from the surface a tool is led. [length]
struct FreeSpace {
  double nearest = 2.0;
  double farthest = 20.0;
};

/// A hand that leads a tool through free space, on a smooth path, cycle after cycle: nothing holds
/// it back. The lengths of the increments are those of `kind`. Throws Error where there is no such
/// space.
std::vector<Motion> free_motions(const Mesh& mesh, const SpatialIndex& index, std::size_t count,
                                 const FreeSpace& space, const MotionKind& kind, Random& random);

}  // namespace keepout::app
