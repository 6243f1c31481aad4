// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/shapes.h"

namespace keepout {

/// Inside/outside classification of a point against a watertight mesh: see find_side.
struct SideOfSurface {
  /// True on the side that the normals point to; false on the surface itself.
  bool is_outside;
  /// The distance from the surface; 0 on it, to within rounding. A lower bound for an outside point
  /// farther away than four diagonals of the mesh's bounds. [length]
  double distance;
  Vec3 outward;  // unit vector to the free side, along the shortest segment to the surface
  Vec3 normal;   // unit normal of the surface at its nearest point
};

}  // namespace keepout
