// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// Where one fault of a mesh is.
struct FaultPlace {
  /// The middle of its corners; of two triangles that meet, a point of both. [length]
  Vec3 at;
  /// One vertex, the two ends of an edge, the three corners of a triangle, or those of the one
  /// triangle and then of the other. [length]
  std::vector<Vec3> corners;
};

/// Where the faults of one kind are.
struct FaultPlaces {
  /// Faults that share vertices are one group: the edges around a hole, the edges of a patch that
  /// is wound the wrong way.
  std::size_t groups = 0;
  /// A bounded number of places: one of each group first, then others.
  std::vector<FaultPlace> places = {};
};

}  // namespace keepout
