// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>

#include "keepout/monitor/triangle_tree.h"
#include "keepout/oracle/distance.h"

namespace keepout::oracle {

/// Returns the sign, -1, 0 or 1, of det(b - a, c - a, d - a). It is 1 for the origin and the three
/// unit vectors in their order. The sign is exact: integers decide if the error bound of double
/// arithmetic does not. Precondition: finite coordinates.
int volume_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Decides if a point is inside a closed surface, for any winding of its triangles. Counts the
/// triangles that a ray in a random direction pierces, with exact decisions.
class InsideTest {
 public:
  /// Counts the triangles at each edge, in O(n log n): about 1 s for a million triangles. Vertices
  /// at the same position count as one.
  explicit InsideTest(std::shared_ptr<const TriangleTree> tree);

  /// Returns true if every edge has an even number of triangles: rays in all directions then agree.
  /// The surface may intersect itself or be nested; a point that is enclosed twice is outside.
  bool closed() const noexcept { return closed_; }

  /// Returns true if the point is strictly inside, and false on the surface. Empty if the surface
  /// is not closed. If a ray meets an edge or a vertex, another direction is tried. The same point
  /// gets the same rays each time. Precondition: finite coordinates.
  std::optional<bool> inside(const Vec3& point) const;

 private:
  std::shared_ptr<const TriangleTree> tree_;
  bool closed_;
};

}  // namespace keepout::oracle
