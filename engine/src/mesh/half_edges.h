// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "keepout/mesh/mesh.h"

namespace keepout {

/// One side of a triangle, filed under the lower of its two vertices.
struct HalfEdge {
  VertexId high;
  TriangleId triangle;
  std::uint8_t edge;
  bool upwards;  // runs from the lower vertex to the higher
};

/// Returns true if a triangle names a vertex twice. It is then a segment without sides, and the
/// triangles beside it are neighbors of each other.
inline bool repeats_a_vertex(const Corners& c) noexcept {
  return c[0] == c[1] || c[1] == c[2] || c[2] == c[0];
}

/// Calls visit(triangle, edge, from, to) for each side of the triangles begin to end - 1.
template <class Visit>
void for_each_side(const Mesh& mesh, std::size_t begin, std::size_t end, const Visit& visit) {
  for (std::size_t t = begin; t < end; ++t) {
    const Corners& c = mesh.corners(static_cast<TriangleId>(t));
    if (repeats_a_vertex(c)) continue;
    for (std::uint8_t e = 0; e < 3; ++e) {
      visit(static_cast<TriangleId>(t), e, c[e], c[(e + 1) % 3]);
    }
  }
}

/// The sides of all triangles of a mesh, in the order of low vertex, high vertex, triangle.
class HalfEdges {
 public:
  /// Builds on one thread for each processor (in adjacency.cpp).
  explicit HalfEdges(const Mesh& mesh);

  std::size_t vertex_count() const noexcept { return begin_.size() - 1; }

  /// Calls visit(low, half_edges) for each edge with a lower vertex in first .. last - 1, with all
  /// sides on the edge, in order.
  template <class Visit>
  void for_each_edge(std::size_t first, std::size_t last, Visit&& visit) const {
    for (std::size_t low = first; low < last; ++low) {
      const std::span all(sides_.data() + begin_[low], sides_.data() + begin_[low + 1]);
      for (auto side = all.begin(); side != all.end();) {
        const auto next =
            std::find_if(side, all.end(), [&](const HalfEdge& h) { return h.high != side->high; });
        visit(static_cast<VertexId>(low), std::span<const HalfEdge>(side, next));
        side = next;
      }
    }
  }

 private:
  std::vector<std::size_t> begin_;  // of each low vertex's sides
  std::vector<HalfEdge> sides_;
};

/// Calls visit(low, half_edges) for each edge of the mesh, one after another.
template <class Visit>
void for_each_edge(const Mesh& mesh, Visit&& visit) {
  const HalfEdges sides(mesh);
  sides.for_each_edge(0, sides.vertex_count(), visit);
}

}  // namespace keepout
