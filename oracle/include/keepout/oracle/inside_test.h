// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>

#include "keepout/oracle/triangle_tree.h"

namespace keepout::oracle {

/// The sign, -1, 0 or 1, of det(b - a, c - a, d - a), which is > 0 for the origin and the three
/// unit vectors in their order. Always right: double arithmetic where its bound allows, integers
/// where not. Precondition: finite coordinates.
int volume_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Tells inside from outside of a closed surface, whichever way its triangles are wound: by the
/// number of triangles that a ray in a random direction pierces, decided exactly.
class InsideTest {
 public:
  /// Counts the triangles at each edge: O(n log n), about 1 s for a million triangles. Vertices at
  /// the same place are one.
  explicit InsideTest(std::shared_ptr<const TriangleTree> tree);

  /// Every edge has an even number of triangles: rays in all directions then agree. A surface that
  /// intersects itself or is nested passes; what is enclosed twice is outside.
  bool closed() const noexcept { return closed_; }

  /// Whether the point is strictly inside; on the surface it is not. Nothing where the surface is
  /// not closed. A ray that meets an edge or a vertex is shot again in another direction. The same
  /// point gets the same rays each time. Precondition: finite coordinates.
  std::optional<bool> inside(const Vec3& point) const;

 private:
  std::shared_ptr<const TriangleTree> tree_;
  bool closed_;
};

}  // namespace keepout::oracle
