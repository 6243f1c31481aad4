// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/fault_places.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Returns true if two triangles of a welded mesh meet outside the vertices and edges that they
/// share. Contact counts, and so do overlapping coplanar triangles and duplicates. The decision is
/// exact, by signs of orientations, without a tolerance. Returns false if either triangle has no
/// area.
bool meet_improperly(const Mesh& mesh, TriangleId one, TriangleId other) noexcept;

/// The pairs of triangles of a mesh that meet_improperly.
struct SelfIntersections {
  std::size_t pairs = 0;    // all of them
  FaultPlaces places = {};  // of some pairs, with the corners of both triangles
};

/// Finds the pairs of triangles that meet_improperly, and the places of at most `most_places` of
/// them. Ignores triangles without an area: they always lie on their neighbors, and examine()
/// counts them separately.
///
/// `index`: of `mesh`. Each triangle needs a query of a few µs, or longer if the triangle is long
/// compared to its neighbors. `examined`: if not empty, called after each triangle.
SelfIntersections find_self_intersections(const Mesh& mesh, const SpatialIndex& index,
                                          std::size_t most_places = 10,
                                          const std::function<void()>& examined = {});

/// Returns the number of pairs that find_self_intersections finds.
std::size_t count_self_intersections(const Mesh& mesh, const SpatialIndex& index);

}  // namespace keepout
