// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/adjacency.h"

#include <Eigen/Geometry>
#include <atomic>
#include <span>
#include <utility>
#include <vector>

#include "../huge_pages.h"
#include "../parallel.h"
#include "half_edges.h"

namespace keepout {
namespace {

/// Calls file(triangle, edge, from, to) for every side of a triangle, on all threads at once.
template <class File>
void share_sides(const Mesh& mesh, const File& file) {
  share_ranges(mesh.triangle_count(), processors(),
               [&](std::size_t begin, std::size_t end) { for_each_side(mesh, begin, end, file); });
}

std::size_t next_place(std::size_t& count) noexcept {
  return std::atomic_ref(count).fetch_add(1, std::memory_order_relaxed);
}

// Smaller bends are rounding, not shape. [rad]
constexpr double flat = 1e-12;

constexpr int next(int corner) noexcept { return (corner + 1) % 3; }

/// Like bend(), for triangles with known unit normals.
EdgeKind bend(const Triangle& one, const Vec3& normal_one, int edge, const Triangle& other,
              const Vec3& normal_other, int other_edge) noexcept {
  // The sine of the turn from one normal to the other about the edge has the sign of -N_a . v. It
  // does not depend on the order of the triangles.
  const Vec3 along = one[next(edge)] - one[edge];
  const double length = along.norm();
  if (!(length > 0.0) || other[other_edge] == other[next(other_edge)]) return EdgeKind::coplanar;
  const double sine = normal_one.cross(normal_other).dot(along) / length;
  if (sine > flat) return EdgeKind::convex;
  if (sine < -flat) return EdgeKind::concave;
  return EdgeKind::coplanar;
}

std::vector<Vec3> normals_of(const Mesh& mesh) {
  auto normals = vector_in_huge_pages<Vec3>(mesh.triangle_count());
  share_ranges(normals.size(), processors(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) normals[t] = mesh.normal(static_cast<TriangleId>(t));
  });
  return normals;
}

}  // namespace

HalfEdges::HalfEdges(const Mesh& mesh) : begin_(mesh.vertex_count() + 2, 0) {
  // A counting sort by lower vertex, then a small sort for each, is faster than one sort of all.
  // The threads file in any order, which the small sorts undo.
  share_sides(mesh, [&](TriangleId, std::uint8_t, VertexId a, VertexId b) {
    next_place(begin_[std::min(a, b) + std::size_t{2}]);
  });
  for (std::size_t v = 1; v < begin_.size(); ++v) begin_[v] += begin_[v - 1];
  sides_ = vector_in_huge_pages<HalfEdge>(begin_.back());
  // begin_[v + 1] is still the beginning of v's sides. The filing moves it to their end.
  share_sides(mesh, [&](TriangleId t, std::uint8_t e, VertexId a, VertexId b) {
    sides_[next_place(begin_[std::min(a, b) + std::size_t{1}])] = {std::max(a, b), t, e, a < b};
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

EdgeKind bend(const Triangle& one, int edge, const Triangle& other, int other_edge) noexcept {
  return bend(one, unit_normal(one), edge, other, unit_normal(other), other_edge);
}

Adjacency::Adjacency(const Mesh& mesh)
    : neighbors_(mesh.triangle_count(), {no_triangle, no_triangle, no_triangle}),
      kinds_(mesh.triangle_count(), {EdgeKind::boundary, EdgeKind::boundary, EdgeKind::boundary}) {
  const HalfEdges half_edges(mesh);
  const std::vector<Vec3> normals = normals_of(mesh);
  const auto set_kind = [&](std::span<const HalfEdge> sides, EdgeKind kind) {
    for (const HalfEdge& side : sides) kinds_[side.triangle][side.edge] = kind;
  };
  const auto join = [&](VertexId, std::span<const HalfEdge> sides) {
    if (sides.size() > 2) set_kind(sides, EdgeKind::non_manifold);
    if (sides.size() != 2) return;
    const HalfEdge& a = sides[0];
    const HalfEdge& b = sides[1];
    neighbors_[a.triangle][a.edge] = b.triangle;
    neighbors_[b.triangle][b.edge] = a.triangle;
    set_kind(sides, a.upwards == b.upwards
                        ? EdgeKind::inconsistent
                        : bend(mesh.triangle(a.triangle), normals[a.triangle], a.edge,
                               mesh.triangle(b.triangle), normals[b.triangle], b.edge));
  };
  // Each side is on one edge only, so no two threads write to the same place.
  share_ranges(half_edges.vertex_count(), processors(), [&](std::size_t first, std::size_t last) {
    half_edges.for_each_edge(first, last, join);
  });
}

}  // namespace keepout
