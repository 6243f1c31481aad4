// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "leaf_edges.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "../geometry/corner_order.h"

namespace keepout {
namespace {

// The least height of a sturdy triangle, as a share of its longest side.
constexpr double sturdy_height = 1e-3;

bool is_sturdy(const Triangle& t) noexcept {
  const double longest2 = std::max(
      {(t[1] - t[0]).squaredNorm(), (t[2] - t[1]).squaredNorm(), (t[0] - t[2]).squaredNorm()});
  return (t[1] - t[0]).cross(t[2] - t[0]).norm() > sturdy_height * longest2;
}

/// The number of the edge between two corners, whichever comes first.
constexpr int edge_between(int i, int j) noexcept { return (4 - i - j) % 3; }

/// The corner of a neighbour that is not on the edge it shares.
Vec3 apex_across(const Mesh& mesh, TriangleId from, int edge, TriangleId neighbor) noexcept {
  const VertexId a = mesh.corners(from)[static_cast<std::size_t>(edge)];
  const VertexId b = mesh.corners(from)[static_cast<std::size_t>((edge + 1) % 3)];
  for (const VertexId v : mesh.corners(neighbor)) {
    if (v != a && v != b) return mesh.vertex(v);
  }
  return mesh.vertex(a);
}

/// A triangle in a leaf, its corners in lexicographic order.
class Bordered {
 public:
  Bordered(const Mesh& mesh, const Adjacency& adjacency, TriangleId t) noexcept
      : mesh_(mesh), t_(t), triangle_(mesh.triangle(t)), order_(corner_order(triangle_)) {
    for (std::size_t side = 0; side < 3; ++side) {
      edges_[side] = edge_between(order_.corner[static_cast<std::size_t>(sides[side][0])],
                                  order_.corner[static_cast<std::size_t>(sides[side][1])]);
      kinds_[side] = adjacency.kind(t, edges_[side]);
      neighbors_[side] = adjacency.neighbor(t, edges_[side]);
    }
  }

  void write(LeafEdges& leaf, std::size_t lane) const noexcept {
    const Vec3& first = triangle_[static_cast<std::size_t>(order_.corner[0])];
    bool sturdy = is_sturdy(triangle_);
    double span = 0.0;
    for (const Vec3& corner : triangle_) span = std::max(span, (corner - first).norm());
    for (std::size_t side = 0; side < 3; ++side) {
      const bool ridge = is_ridge(side);
      const Vec3 apex = ridge ? apex_across(mesh_, t_, edges_[side], neighbors_[side]) : first;
      sturdy = sturdy && (!ridge || is_sturdy(mesh_.triangle(neighbors_[side])));
      span = std::max(span, (apex - first).norm());
      for (int axis = 0; axis < 3; ++axis) {
        leaf.apex[side][axis][lane] = static_cast<float>(apex[axis]);
      }
    }
    const Vec3 normal = unit_normal(triangle_);
    for (int axis = 0; axis < 3; ++axis) {
      leaf.normal[axis][lane] = static_cast<float>(normal[axis]);
    }
    leaf.span[lane] = static_cast<float>(span * (1.0 + 1e-6));
    leaf.roles[lane] = 0;
    leaf.corners[lane] = LeafEdges::used | (sturdy ? LeafEdges::sturdy : 0);
    for (std::size_t place = 0; place < places; ++place) {
      leaf.roles[lane] |= roles_at(place) << (LeafEdges::role_bits * place);
      leaf.corners[lane] |= corners_at(place) << (LeafEdges::corner_bits * place);
    }
  }

 private:
  bool is_ridge(std::size_t side) const noexcept {
    return kinds_[side] == EdgeKind::convex || kinds_[side] == EdgeKind::coplanar;
  }

  std::uint32_t roles_of(std::size_t side) const noexcept {
    if (kinds_[side] == EdgeKind::concave) return LeafEdges::valley;
    if (!is_ridge(side)) return 0;
    return LeafEdges::first_ridge | (neighbors_[side] < t_ ? LeafEdges::first_lower : 0);
  }

  std::uint32_t roles_at(std::size_t place) const noexcept {
    if (place >= 3) return roles_of(place - 3);
    const auto [one, other] = sides_at[place];
    const std::uint32_t second = roles_of(static_cast<std::size_t>(other));
    return roles_of(static_cast<std::size_t>(one)) | (second & LeafEdges::valley) |
           (second & ~LeafEdges::valley) << 2;
  }

  std::uint32_t corners_at(std::size_t place) const noexcept {
    const int low = place < 3 ? static_cast<int>(place) : sides[place - 3][0];
    const int high = place < 3 ? low : sides[place - 3][1];
    return static_cast<std::uint32_t>(order_.corner[static_cast<std::size_t>(low)]) |
           static_cast<std::uint32_t>(order_.corner[static_cast<std::size_t>(high)]) << 2;
  }

  const Mesh& mesh_;
  TriangleId t_;
  Triangle triangle_;
  CornerOrder order_;
  std::array<int, 3> edges_{};  // of each side
  std::array<EdgeKind, 3> kinds_{};
  std::array<TriangleId, 3> neighbors_{};
};

}  // namespace

std::vector<LeafEdges> edges_of_leaves(const WideBvh& tree, const Adjacency& adjacency) {
  std::vector<LeafEdges> edges(tree.leaves().size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const LeafBlock& leaf = tree.leaves()[i];
    for (std::size_t lane = 0; lane < LeafBlock::lanes && leaf.is_used(lane); ++lane) {
      Bordered(tree.mesh(), adjacency, leaf.triangle(lane)).write(edges[i], lane);
    }
  }
  return edges;
}

}  // namespace keepout
