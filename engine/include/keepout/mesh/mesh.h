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

/// Three vertices, in the order of the winding: seen from the free side, counter-clockwise.
using Corners = std::array<VertexId, 3>;

/// An indexed triangle surface as plain data: what readers and generators make, and what a Mesh is
/// made from. Any one length unit.
struct Surface {
  std::vector<Vec3> vertices;      // [length]
  std::vector<Corners> triangles;  // by the numbers of their vertices
};

/// An immutable triangle surface: shared by every index and rule that is built on it. It may be
/// open, non-manifold or self-intersecting. Triangle ids are the order of the triangles given.
class Mesh {
 public:
  /// Throws Error when there is no triangle, when a coordinate is not finite, when a triangle names
  /// a vertex that does not exist, or when there are more than 2^32 - 2 triangles.
  explicit Mesh(Surface surface);
  /// The same triangles.
  Mesh(const Mesh&) = default;
  /// There is none: what was built on it would be of another mesh.
  Mesh& operator=(const Mesh&) = delete;
  ~Mesh() = default;

  /// A number that tells it, and its copies, apart from every other mesh of this process.
  std::uint64_t id() const noexcept { return id_; }

  /// At least 1.
  std::size_t triangle_count() const noexcept { return surface_.triangles.size(); }
  /// Those that no triangle uses included.
  std::size_t vertex_count() const noexcept { return surface_.vertices.size(); }

  /// The vertices of a triangle. Precondition: t < triangle_count().
  const Corners& corners(TriangleId t) const noexcept { return surface_.triangles[t]; }
  /// Where a vertex is. Precondition: v < vertex_count(). [length]
  const Vec3& vertex(VertexId v) const noexcept { return surface_.vertices[v]; }

  /// Where the corners of a triangle are. Precondition: t < triangle_count(). [length]
  Triangle triangle(TriangleId t) const noexcept {
    const Corners& c = corners(t);
    return {vertex(c[0]), vertex(c[1]), vertex(c[2])};
  }

  /// Unit normal from the winding; zero for a triangle without an area.
  Vec3 normal(TriangleId t) const noexcept { return unit_normal(triangle(t)); }

  /// All vertices, by their number. [length]
  std::span<const Vec3> vertices() const noexcept { return surface_.vertices; }
  /// All triangles, by their number.
  std::span<const Corners> triangles() const noexcept { return surface_.triangles; }

  /// The smallest axis-aligned box around the triangles.
  const Box& bounds() const noexcept { return bounds_; }

  /// Of all triangles. [length]
  double longest_edge() const noexcept { return longest_edge_; }

 private:
  Surface surface_;
  Box bounds_;
  double longest_edge_ = 0.0;
  std::uint64_t id_;
};

/// Merges the vertices whose coordinates are exactly equal (0 and -0 are), and leaves all others
/// apart, however close. Triangles keep their order and winding; none is dropped, degenerate ones
/// neither. Vertices are numbered by their first use; vertices that no triangle uses disappear.
///
/// `threads`: at most; 0 for as many as there are processors. The result is the same.
Surface weld(Surface surface, unsigned threads = 0);

}  // namespace keepout
