// SPDX-License-Identifier: BSD-3-Clause
#include "half_edges.h"

#include <atomic>
#include <utility>

#include "../huge_pages.h"
#include "../parallel.h"

namespace keepout {
namespace {

/// Calls file(triangle, edge, from, to) for every side of a triangle, on all threads at once.
template <class File>
void share_sides(const Mesh& mesh, const File& file) {
  share_ranges(mesh.triangle_count(), processors(),
               [&](std::size_t begin, std::size_t end) { for_each_side(mesh, begin, end, file); });
}

std::size_t next(std::size_t& count) noexcept {
  return std::atomic_ref(count).fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

HalfEdges::HalfEdges(const Mesh& mesh) : begin_(mesh.vertex_count() + 2, 0) {
  // A counting sort by lower vertex, then a small sort for each: faster than one sort of all. The
  // threads file in any order, which the small sorts undo.
  share_sides(mesh, [&](TriangleId, std::uint8_t, VertexId a, VertexId b) {
    next(begin_[std::min(a, b) + std::size_t{2}]);
  });
  for (std::size_t v = 1; v < begin_.size(); ++v) begin_[v] += begin_[v - 1];
  sides_ = vector_in_huge_pages<HalfEdge>(begin_.back());
  // begin_[v + 1], as yet where v's sides begin, moves on to where they end.
  share_sides(mesh, [&](TriangleId t, std::uint8_t e, VertexId a, VertexId b) {
    sides_[next(begin_[std::min(a, b) + std::size_t{1}])] = {std::max(a, b), t, e, a < b};
  });
  begin_.pop_back();

  share_ranges(mesh.vertex_count(), processors(), [&](std::size_t first, std::size_t last) {
    for (std::size_t low = first; low < last; ++low) {
      std::sort(sides_.data() + begin_[low], sides_.data() + begin_[low + 1],
                [](const HalfEdge& a, const HalfEdge& b) {
                  return a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
                });
    }
  });
}

}  // namespace keepout
