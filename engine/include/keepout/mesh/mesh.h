// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "keepout/geometry/shapes.h"
#include "keepout/ids.h"

namespace keepout {

/// The three vertices of a triangle in the order of its winding: counter-clockwise from the free
/// side.
using Corners = std::array<VertexId, 3>;

/// An indexed triangle surface as plain data, from which a Mesh is made. All lengths have the same
/// unit.
struct Surface {
  std::vector<Vec3> vertices;      // [length]
  std::vector<Corners> triangles;  // the numbers of their vertices
};

/// An immutable triangle surface, shared by indices and rules. It may be open, non-manifold or
/// self-intersecting. Triangle ids follow the order of the given triangles.
class Mesh {
 public:
  /// Makes a mesh of a surface. Throws Error for no triangle or more than 2^32 - 2 triangles, a
  /// coordinate that is not finite, or a triangle that names a vertex that does not exist.
  explicit Mesh(Surface surface);
  /// Copies the triangles and the id.
  Mesh(const Mesh&) = default;
  /// Deleted: indices and rules refer to the mesh.
  Mesh& operator=(const Mesh&) = delete;
  ~Mesh() = default;

  /// Returns a number that only this mesh and its copies have in this process.
  std::uint64_t id() const noexcept { return id_; }

  /// Returns the number of triangles, at least 1.
  std::size_t triangle_count() const noexcept { return surface_.triangles.size(); }
  /// Returns the number of vertices, including those that no triangle uses.
  std::size_t vertex_count() const noexcept { return surface_.vertices.size(); }

  /// Returns the vertices of a triangle. Precondition: t < triangle_count().
  const Corners& corners(TriangleId t) const noexcept { return surface_.triangles[t]; }
  /// Returns the position of a vertex. Precondition: v < vertex_count(). [length]
  const Vec3& vertex(VertexId v) const noexcept { return surface_.vertices[v]; }

  /// Returns the positions of the corners of a triangle. Precondition: t < triangle_count().
  /// [length]
  Triangle triangle(TriangleId t) const noexcept {
    const Corners& c = corners(t);
    return {vertex(c[0]), vertex(c[1]), vertex(c[2])};
  }

  /// Returns the unit normal by the winding; zero for a triangle without an area.
  Vec3 normal(TriangleId t) const noexcept { return unit_normal(triangle(t)); }

  /// Returns all vertices, by their number. [length]
  std::span<const Vec3> vertices() const noexcept { return surface_.vertices; }
  /// Returns all triangles, by their number.
  std::span<const Corners> triangles() const noexcept { return surface_.triangles; }

  /// Returns the smallest axis-aligned box around the triangles.
  const Box& bounds() const noexcept { return bounds_; }

  /// Returns the longest edge of all triangles. [length]
  double longest_edge() const noexcept { return longest_edge_; }

 private:
  Surface surface_;
  Box bounds_;
  double longest_edge_ = 0.0;
  std::uint64_t id_;
};

/// Merges vertices with exactly equal coordinates (0 equals -0); does not merge close ones.
/// Triangles keep their order and winding, and no triangle is dropped, not even a degenerate one.
/// Vertices are numbered by their first use; unused vertices are removed.
///
/// `threads`: the most to use; 0: as many as there are processors. The result does not depend on
/// it.
Surface weld(Surface surface, unsigned threads = 0);

}  // namespace keepout
