// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// The place of one fault of a mesh.
struct FaultPlace {
  /// The mean of the corners; for two triangles that intersect, a common point. [length]
  Vec3 at;
  /// One vertex, the two ends of an edge, the three corners of a triangle, or the six corners of
  /// two triangles. [length]
  std::vector<Vec3> corners;
};

/// The places of the faults of one kind.
struct FaultPlaces {
  /// The number of groups. Faults that share vertices are one group, such as the edges around a
  /// hole, or around a patch of wrong winding.
  std::size_t groups = 0;
  /// A bounded number of places: first one of each group, then others.
  std::vector<FaultPlace> places = {};
};

}  // namespace keepout
