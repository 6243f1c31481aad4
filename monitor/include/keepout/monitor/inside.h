// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "keepout/geometry/shapes.h"
#include "keepout/mesh/mesh.h"
#include "keepout/monitor/triangle_tree.h"

namespace keepout::monitor {

/// Returns the sign, -1, 0 or 1, of det(b - a, c - a, d - a). It is 1 for the origin and the three
/// unit vectors in their order. Empty if rounding hides the sign. Precondition: finite coordinates.
std::optional<int> volume_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) noexcept;

enum class Piercing : std::uint8_t { no, yes, unclear };

/// Decides if a segment pierces a triangle. Returns `unclear` if the line meets the border of the
/// triangle, or the segment starts on the triangle. `sign` returns the exact sign of volume_sign(),
/// or 0 if it is unknown. Precondition: `to` is not in the triangle's plane, or the
/// line misses the triangle.
template <class Sign>
Piercing piercing(const Segment& segment, const Triangle& t, const Sign& sign) noexcept {
  int left = 0, right = 0;
  for (int i = 0; i < 3; ++i) {
    const int side = sign(segment.from, segment.to, t[i], t[(i + 1) % 3]);
    left += side > 0;
    right += side < 0;
  }
  if (left > 0 && right > 0) return Piercing::no;
  if (left + right < 3) return Piercing::unclear;
  const int from_side = sign(segment.from, t[0], t[1], t[2]);
  const int to_side = sign(segment.to, t[0], t[1], t[2]);
  if (from_side == 0 || to_side == 0) return Piercing::unclear;
  return from_side == to_side ? Piercing::no : Piercing::yes;
}

/// Returns true if every edge has an even number of triangles. Vertices at the same position count
/// as one. Takes O(n log n): about 1 s for a million triangles.
bool is_closed(const Mesh& mesh);

/// Returns the end of a segment from a point in the bounds of a surface to a point beyond them. The
/// end is not in the plane of a triangle that the segment pierces. Precondition: all
/// coordinates of `direction` have a magnitude of 0.25 to 1.
Vec3 beyond(const TriangleTree& tree, const Vec3& point, const Vec3& direction) noexcept;

/// Decides on which side of a closed surface a point is, in double arithmetic and bounded work.
class SideTest {
 public:
  /// Takes O(n log n). `most_triangles`: that a ray may meet; all memory is allocated here.
  SideTest(std::shared_ptr<const TriangleTree> tree, std::uint64_t most_triangles);

  /// Returns true if the point is strictly on the forbidden side, to which no normal points, in at
  /// most `work` units: one for each node and each triangle. Empty if the work ends, if the surface
  /// is not closed or has no volume, and if all rays are too close to an edge or a vertex.
  std::optional<bool> is_forbidden(const Vec3& point, std::uint64_t work) noexcept;

 private:
  std::shared_ptr<const TriangleTree> tree_;
  std::vector<TriangleId> found_;
  std::uint64_t most_triangles_;
  int inside_ = 0;  // 1: the inside is forbidden; -1: the outside is; 0: not closed
};

}  // namespace keepout::monitor
