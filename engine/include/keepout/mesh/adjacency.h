// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "keepout/mesh/mesh.h"

namespace keepout {

/// What an edge is to the surface around it. Names are those of the anatomy: convex is a ridge,
/// concave a valley (docs/conventions.md). The paper's own wording is about the constraint set,
/// which is the opposite.
enum class EdgeKind : std::uint8_t {
  convex,        // two triangles, a ridge
  concave,       // two triangles, a valley
  coplanar,      // two triangles, flat or folded back by half a turn
  boundary,      // one triangle
  non_manifold,  // three triangles or more
  inconsistent,  // two triangles whose windings contradict each other
};

/// Which triangle lies across each edge of a welded mesh, and how the surface bends there. Only the
/// rules that reason about neighbors need it: it is built apart from the mesh.
class Adjacency {
 public:
  /// Of a welded mesh, on all processors. The mesh need not outlive it.
  explicit Adjacency(const Mesh& mesh);

  /// The triangle across edge `edge` (0, 1, 2) of `t`, or no_triangle at a boundary or a
  /// non-manifold edge.
  TriangleId neighbor(TriangleId t, int edge) const noexcept { return neighbors_[t][edge]; }

  /// What edge `edge` (0, 1, 2) of `t` is to the surface; the same from both sides.
  EdgeKind kind(TriangleId t, int edge) const noexcept { return kinds_[t][edge]; }

 private:
  std::vector<std::array<TriangleId, 3>> neighbors_;
  std::vector<std::array<EdgeKind, 3>> kinds_;
};

/// How the surface bends over the edge between two triangles, by the sign of N_a . v: N_a the
/// normal of the one, v the edge of the other from a shared vertex to its apex (Li et al. 2020,
/// section III-A, with v read as the errata say). Symmetric in the two triangles. Bends below
/// 1e-12 rad, and triangles without an area, count as coplanar.
EdgeKind bend(const Triangle& one, int edge, const Triangle& other, int other_edge) noexcept;

}  // namespace keepout
