// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/shapes.h"

namespace keepout {

/// Inside/outside classification of a point against a watertight mesh: see find_side.
struct SideOfSurface {
  /// True on the side that the normals point to, false on the surface itself.
  bool is_outside;
  /// From the surface; 0 on it, to within rounding. Of an outside point that is farther away than
  /// four diagonals of the mesh's bounds, a lower bound. [length]
  double distance;
  Vec3 outward;  // unit vector across the surface to the free side, along the shortest segment
  Vec3 normal;   // unit vector: of the surface at its nearest point
};

}  // namespace keepout
