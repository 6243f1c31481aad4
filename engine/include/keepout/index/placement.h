// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "keepout/geometry/shapes.h"
#include "keepout/index/query.h"

namespace keepout {

/// Where a tip is that no step has led to: at the start, or after the caller has moved it.
struct Placement {
  /// Whether it is on the side that normals point to; not so on the surface itself.
  bool is_free;
  /// From the surface; on it, to within rounding, 0 and not free. Of a free tip that is farther
  /// off than four times the mesh is large, less than that. [length]
  double distance;
  Vec3 way_out;  // unit vector: to the surface from the forbidden side, off it from the free one
  Vec3 normal;   // unit vector: of the surface at its nearest point
};

/// Places a tip by the winding of a watertight mesh that does not cut through itself. It looks from
/// the tip at a point close to the nearest one, inside of that triangle which faces the tip the
/// most: the side of the first triangle met on the way is the tip's. So no sum of normals has to be
/// trusted, and no decision of rounding about which of several triangles is the nearest.
///
/// The same whatever the order of triangles and corners. Nothing when more triangles are about as
/// near than there is room for, or the budget is spent. Allocates nothing. Precondition: the mesh
/// is watertight.
std::optional<Placement> place(Neighborhood& near, const Vec3& tip) noexcept;

}  // namespace keepout
