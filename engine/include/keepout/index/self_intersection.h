// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/fault_places.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// True if the triangles one and other of a welded mesh meet elsewhere than in the vertices and the
/// edge that they share. Touching counts; so do coplanar triangles that overlap, and duplicates.
/// Decided exactly, by signs of orientations: no tolerance. False if either has no area.
bool meet_improperly(const Mesh& mesh, TriangleId one, TriangleId other) noexcept;

/// The pairs of triangles of a mesh that meet_improperly.
struct SelfIntersections {
  std::size_t pairs = 0;    // all of them
  FaultPlaces places = {};  // of some; each has the corners of both triangles
};

/// Finds the pairs of triangles that meet_improperly, and where at most `most_places` of them are.
/// Triangles without an area are left out: they lie on their neighbors wherever they are, and
/// examine() counts them apart.
///
/// `index` is one over `mesh`, asked for the surroundings of each triangle: a few microseconds
/// each. Where triangles are long beside their neighbors it takes longer. Calls `examined`, if
/// there is one, after each triangle.
SelfIntersections find_self_intersections(const Mesh& mesh, const SpatialIndex& index,
                                          std::size_t most_places = 10,
                                          const std::function<void()>& examined = {});

/// Returns the number of pairs that find_self_intersections finds.
std::size_t count_self_intersections(const Mesh& mesh, const SpatialIndex& index);

}  // namespace keepout
