// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include "keepout/mesh/adjacency.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <span>

namespace keepout {
namespace {

// Bends below this are rounding, not shape. [rad]
constexpr double flat = 1e-12;

/// One side of one triangle, filed under the lower of its two vertices.
struct HalfEdge {
  VertexId high;
  TriangleId triangle;
  std::uint8_t edge;
  bool upwards;  // runs from the lower vertex to the higher

  auto operator<=>(const HalfEdge&) const = default;
};

constexpr int next(int corner) noexcept { return (corner + 1) % 3; }

bool repeats_a_vertex(const Corners& c) noexcept {
  return c[0] == c[1] || c[1] == c[2] || c[2] == c[0];
}

/// The half-edges of all triangles, grouped by lower vertex: begin[v] .. begin[v + 1].
struct HalfEdgeTable {
  std::vector<std::size_t> begin;
  std::vector<HalfEdge> half_edges;
};

HalfEdgeTable half_edges_by_vertex(const Mesh& mesh) {
  HalfEdgeTable table;
  table.begin.assign(mesh.vertex_count() + 1, 0);
  // A triangle that names a vertex twice is a segment: it has no sides, and the triangles beside it
  // are neighbours of each other.
  const auto for_each = [&](auto&& visit) {
    for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
      const Corners& c = mesh.corners(t);
      if (repeats_a_vertex(c)) continue;
      for (int e = 0; e < 3; ++e) visit(t, e, c[e], c[next(e)]);
    }
  };
  for_each([&](TriangleId, int, VertexId a, VertexId b) { ++table.begin[std::min(a, b) + 1]; });
  for (std::size_t v = 1; v < table.begin.size(); ++v) table.begin[v] += table.begin[v - 1];

  table.half_edges.resize(table.begin.back());
  std::vector<std::size_t> fill(table.begin.begin(), table.begin.end() - 1);
  for_each([&](TriangleId t, int e, VertexId a, VertexId b) {
    table.half_edges[fill[std::min(a, b)]++] = {std::max(a, b), t, static_cast<std::uint8_t>(e),
                                                a < b};
  });
  return table;
}

}  // namespace

EdgeKind bend(const Triangle& one, int edge, const Triangle& other, int other_edge) noexcept {
  const Vec3 normal_one = unit_normal(one);
  const Vec3 normal_other = unit_normal(other);
  // The sine of the turn from the one normal to the other about the edge has the sign of -N_a . v,
  // and is the same whichever of the two comes first.
  const Vec3 along = one[next(edge)] - one[edge];
  const double length = along.norm();
  if (!(length > 0.0) || other[other_edge] == other[next(other_edge)]) return EdgeKind::coplanar;
  const double sine = normal_one.cross(normal_other).dot(along) / length;
  if (sine > flat) return EdgeKind::convex;
  if (sine < -flat) return EdgeKind::concave;
  return EdgeKind::coplanar;
}

Adjacency::Adjacency(const Mesh& mesh)
    : neighbors_(mesh.triangle_count(), {no_triangle, no_triangle, no_triangle}),
      kinds_(mesh.triangle_count(), {EdgeKind::boundary, EdgeKind::boundary, EdgeKind::boundary}) {
  HalfEdgeTable table = half_edges_by_vertex(mesh);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const std::span around(table.half_edges.begin() + table.begin[v],
                           table.half_edges.begin() + table.begin[v + 1]);
    std::sort(around.begin(), around.end());
    for (std::size_t i = 0; i < around.size();) {
      std::size_t j = i + 1;
      while (j < around.size() && around[j].high == around[i].high) ++j;
      if (j - i == 2) {
        const HalfEdge& a = around[i];
        const HalfEdge& b = around[i + 1];
        neighbors_[a.triangle][a.edge] = b.triangle;
        neighbors_[b.triangle][b.edge] = a.triangle;
        const EdgeKind kind = a.upwards == b.upwards
                                  ? EdgeKind::inconsistent
                                  : bend(mesh.triangle(a.triangle), a.edge,
                                         mesh.triangle(b.triangle), b.edge);
        kinds_[a.triangle][a.edge] = kind;
        kinds_[b.triangle][b.edge] = kind;
      } else if (j - i > 2) {
        for (std::size_t k = i; k < j; ++k) {
          kinds_[around[k].triangle][around[k].edge] = EdgeKind::non_manifold;
        }
      }
      i = j;
    }
  }
}

}  // namespace keepout
