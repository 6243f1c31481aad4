// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "keepout/mesh/mesh.h"

namespace keepout {

/// One side of one triangle, filed under the lower of its two vertices.
struct HalfEdge {
  VertexId high;
  TriangleId triangle;
  std::uint8_t edge;
  bool upwards;  // runs from the lower vertex to the higher

  auto operator<=>(const HalfEdge&) const = default;
};

/// A triangle that names a vertex twice is a segment: it has no sides, and the triangles beside it
/// are neighbours of each other.
inline bool repeats_a_vertex(const Corners& c) noexcept {
  return c[0] == c[1] || c[1] == c[2] || c[2] == c[0];
}

/// Calls visit(low, half_edges) for each edge of the mesh, with all the sides that lie on it, in
/// the order of low vertex, high vertex, triangle.
template <class Visit>
void for_each_edge(const Mesh& mesh, Visit&& visit) {
  const auto for_each_side = [&](auto&& file) {
    for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
      const Corners& c = mesh.corners(t);
      if (repeats_a_vertex(c)) continue;
      for (std::uint8_t e = 0; e < 3; ++e) file(t, e, c[e], c[(e + 1) % 3]);
    }
  };
  // A counting sort by lower vertex, then a small sort for each: faster than one sort of all.
  std::vector<std::size_t> begin(mesh.vertex_count() + 1, 0);
  for_each_side(
      [&](TriangleId, std::uint8_t, VertexId a, VertexId b) { ++begin[std::min(a, b) + 1]; });
  for (std::size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
  std::vector<HalfEdge> sides(begin.back());
  std::vector<std::size_t> fill(begin.begin(), begin.end() - 1);
  for_each_side([&](TriangleId t, std::uint8_t e, VertexId a, VertexId b) {
    sides[fill[std::min(a, b)]++] = {std::max(a, b), t, e, a < b};
  });

  for (VertexId low = 0; low < mesh.vertex_count(); ++low) {
    const auto last = sides.begin() + begin[low + 1];
    auto first = sides.begin() + begin[low];
    std::sort(first, last);
    while (first != last) {
      const auto next =
          std::find_if(first, last, [&](const HalfEdge& h) { return h.high != first->high; });
      visit(low, std::span<const HalfEdge>(first, next));
      first = next;
    }
  }
}

}  // namespace keepout
