// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// True if the triangles one and other of a welded mesh meet elsewhere than in the vertices and the
/// edge that they share. Touching counts; so do coplanar triangles that overlap, and duplicates.
/// Decided exactly, by signs of orientations: no tolerance. False if either has no area.
bool meet_improperly(const Mesh& mesh, TriangleId one, TriangleId other) noexcept;

/// The number of pairs of triangles that meet_improperly. Triangles without an area are left out:
/// they lie on their neighbours wherever they are, and the doctor counts them apart.
///
/// `index` is one over `mesh`, asked for the surroundings of each triangle: a few microseconds
/// each. Where triangles are long beside their neighbours it takes longer.
std::size_t count_self_intersections(const Mesh& mesh, const SpatialIndex& index);

}  // namespace keepout
