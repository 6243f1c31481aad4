// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/repair.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "half_edges.h"
#include "keepout/geometry/orientation.h"

namespace keepout {
namespace {

/// Rotates the corners so that the lowest vertex is first. The result is equal for triangles with
/// the same vertices and winding.
Corners rotated(Corners c) noexcept {
  std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
  return c;
}

Corners sorted(Corners c) noexcept {
  std::sort(c.begin(), c.end());
  return c;
}

/// Removes the triangles that are marked in `is_faulty`.
void remove(Surface& surface, const std::vector<bool>& is_faulty) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (!is_faulty[t]) surface.triangles[kept++] = surface.triangles[t];
  }
  surface.triangles.resize(kept);
}

void remove_segments(Surface& surface, RemovedTriangles& removed) {
  removed.degenerate += std::erase_if(surface.triangles, repeats_a_vertex);
}

void remove_duplicates(Surface& surface, RemovedTriangles& removed) {
  std::vector<std::pair<Corners, std::size_t>> order;
  order.reserve(surface.triangles.size());
  for (const Corners& c : surface.triangles) order.emplace_back(sorted(c), order.size());
  std::sort(order.begin(), order.end());
  std::vector<bool> is_duplicate(order.size(), false);
  std::size_t first = 0;
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (order[i].first != order[first].first) {
      first = i;
      continue;
    }
    is_duplicate[order[i].second] = true;
    ++removed.duplicates;
    if (rotated(surface.triangles[order[i].second]) !=
        rotated(surface.triangles[order[first].second])) {
      ++removed.opposite_duplicates;
    }
  }
  remove(surface, is_duplicate);
}

void remove_lone_collinear(Surface& surface, RemovedTriangles& removed) {
  if (surface.triangles.empty()) return;
  const Mesh mesh(surface);
  std::vector<bool> is_removed(mesh.triangle_count(), false);
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    is_removed[t] = axis_of_sight(mesh.triangle(t)) < 0;
    if (is_removed[t]) ++removed.collinear_left;
  }
  if (removed.collinear_left == 0) return;
  for_each_edge(mesh, [&](VertexId, std::span<const HalfEdge> sides) {
    if (sides.size() == 1) return;
    for (const HalfEdge& side : sides) is_removed[side.triangle] = false;
  });
  const auto count =
      static_cast<std::size_t>(std::count(is_removed.begin(), is_removed.end(), true));
  removed.degenerate += count;
  removed.collinear_left -= count;
  remove(surface, is_removed);
}

}  // namespace

RemovedTriangles remove_faulty_triangles(Surface& surface) {
  RemovedTriangles removed;
  remove_segments(surface, removed);
  remove_duplicates(surface, removed);
  remove_lone_collinear(surface, removed);
  surface = weld(std::move(surface));
  return removed;
}

}  // namespace keepout
