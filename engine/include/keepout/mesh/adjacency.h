// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "keepout/mesh/mesh.h"

namespace keepout {

/// The kind of an edge. The names refer to the anatomy: convex is a ridge, concave a valley
/// (docs/conventions.md). Li et al. (2020) use the opposite names, which refer to the constraint
/// set.
enum class EdgeKind : std::uint8_t {
  convex,        // two triangles, a ridge
  concave,       // two triangles, a valley
  coplanar,      // two triangles, flat or folded by half a turn
  boundary,      // one triangle
  non_manifold,  // three triangles or more
  inconsistent,  // two triangles whose windings contradict each other
};

/// The triangle across each edge of a welded mesh, and the kind of each edge. It is separate from
/// the mesh, because only rules that use neighbors need it.
class Adjacency {
 public:
  /// Computes the adjacency of a welded mesh, on all processors. The mesh need not outlive it.
  explicit Adjacency(const Mesh& mesh);

  /// Returns the triangle across edge `edge` (0, 1, 2) of `t`; no_triangle at a boundary or a
  /// non-manifold edge.
  TriangleId neighbor(TriangleId t, int edge) const noexcept { return neighbors_[t][edge]; }

  /// Returns the kind of edge `edge` (0, 1, 2) of `t`; both triangles of an edge agree.
  EdgeKind kind(TriangleId t, int edge) const noexcept { return kinds_[t][edge]; }

 private:
  std::vector<std::array<TriangleId, 3>> neighbors_;
  std::vector<std::array<EdgeKind, 3>> kinds_;
};

/// Returns the kind of the edge between two triangles by the sign of N_a . v. N_a is the normal of
/// one triangle. v is the edge of the other triangle from a shared vertex to the third vertex (Li
/// et al. 2020, section III-A; v as in the errata of docs/activation.md). Symmetric in the two
/// triangles. Angles below 1e-12 rad, and triangles without an area, count as coplanar.
EdgeKind bend(const Triangle& one, int edge, const Triangle& other, int other_edge) noexcept;

}  // namespace keepout
