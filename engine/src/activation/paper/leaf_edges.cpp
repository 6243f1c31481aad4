// SPDX-License-Identifier: BSD-3-Clause
#include "leaf_edges.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "../../geometry/corner_order.h"

namespace keepout {
namespace {

bool is_sturdy(const Triangle& t) noexcept {
  constexpr double least_height = 1e-3;  // as a fraction of the longest side
  const double longest2 = std::max(
      {(t[1] - t[0]).squaredNorm(), (t[2] - t[1]).squaredNorm(), (t[0] - t[2]).squaredNorm()});
  return (t[1] - t[0]).cross(t[2] - t[0]).norm() > least_height * longest2;
}

/// Returns the corner of a neighbor that is not on the shared edge.
Vec3 apex_across(const Mesh& mesh, TriangleId from, int edge, TriangleId neighbor) noexcept {
  const VertexId a = mesh.corners(from)[static_cast<std::size_t>(edge)];
  const VertexId b = mesh.corners(from)[static_cast<std::size_t>((edge + 1) % 3)];
  for (const VertexId v : mesh.corners(neighbor)) {
    if (v != a && v != b) return mesh.vertex(v);
  }
  return mesh.vertex(a);
}

void write(const Vec3& vector, float (&to)[3][LeafBlock::lanes], std::size_t lane) noexcept {
  for (int axis = 0; axis < 3; ++axis) to[axis][lane] = static_cast<float>(vector[axis]);
}

}  // namespace

LeafEdges edges_of(const LeafBlock& leaf, const LeafFrame& frame, const Mesh& mesh,
                   const Adjacency& adjacency) noexcept {
  LeafEdges edges{};
  for (std::size_t lane = 0; lane < LeafBlock::lanes && leaf.is_used(lane); ++lane) {
    const TriangleId t = leaf.triangle(lane);
    const Triangle triangle = mesh.triangle(t);
    const CornerOrder order = corner_order(triangle);
    const Vec3& first = triangle[static_cast<std::size_t>(order.corner[0])];
    bool sturdy = is_sturdy(triangle);
    double span = 0.0;
    for (const Vec3& corner : triangle) span = std::max(span, (corner - first).norm());

    std::uint32_t roles[3] = {};  // of each side, as the first one at a place
    for (std::size_t side = 0; side < 3; ++side) {
      // The edge between two corners, in either order.
      const auto [from, to] = corners_at[3 + side];
      const int edge = (4 - order.corner[from] - order.corner[to]) % 3;
      const EdgeKind kind = adjacency.kind(t, edge);
      Vec3 apex = first;
      if (kind == EdgeKind::concave) roles[side] = LeafEdges::valley;
      if (kind == EdgeKind::convex || kind == EdgeKind::coplanar) {
        const TriangleId neighbor = adjacency.neighbor(t, edge);
        roles[side] = LeafEdges::ridge[0] | (neighbor < t ? LeafEdges::lower[0] : 0);
        sturdy = sturdy && is_sturdy(mesh.triangle(neighbor));
        apex = apex_across(mesh, t, edge, neighbor);
        span = std::max(span, (apex - first).norm());
      }
      write(apex - frame.origin, edges.apex[side], lane);
    }
    write(unit_normal(triangle), edges.normal, lane);
    edges.span[lane] = static_cast<float>(span * (1.0 + 1e-6));
    edges.roles[lane] = LeafEdges::used | (sturdy ? LeafEdges::sturdy : 0);
    for (std::size_t place = 0; place < places; ++place) {
      const std::uint32_t one = roles[sides_at[place][0]];
      const std::uint32_t other = place < 3 ? roles[sides_at[place][1]] : 0;
      const std::uint32_t second = (other & LeafEdges::valley) | (other & ~LeafEdges::valley) << 2;
      edges.roles[lane] |= (one | second) << (LeafEdges::role_bits * place);
    }
  }
  return edges;
}

}  // namespace keepout
