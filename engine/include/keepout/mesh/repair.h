// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "keepout/mesh/mesh.h"

namespace keepout {

/// The triangles that remove_faulty_triangles() removed, and those that it left.
struct RemovedTriangles {
  std::size_t degenerate = 0;           // without an area
  std::size_t duplicates = 0;           // same three vertices as an earlier one, any winding
  std::size_t opposite_duplicates = 0;  // duplicates wound against the earlier one
  std::size_t collinear_left = 0;       // without an area, but other triangles share their edges
};

/// Removes triangles that name a vertex twice, and all but the first of those with the same three
/// vertices. Removes a triangle whose three vertices are on one line only if no other triangle has
/// one of its edges. Otherwise a gap would open between its neighbors. Then welds the surface,
/// which removes the vertices that no triangle uses. Triangles keep their order. Precondition: the
/// surface is welded. Throws Error like Mesh, but leaves a surface without triangles if all are
/// faulty.
RemovedTriangles remove_faulty_triangles(Surface& surface);

}  // namespace keepout
