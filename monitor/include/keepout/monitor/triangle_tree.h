// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "keepout/ids.h"
#include "keepout/mesh/mesh.h"
#include "keepout/monitor/distance.h"

namespace keepout::monitor {

/// An axis-aligned box. [length]
struct Bounds {
  Vec3 low;
  Vec3 high;

  /// Returns true if the boxes overlap or touch. Exact: only comparisons.
  bool overlaps(const Bounds& other) const noexcept {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
  bool contains(const Bounds& other) const noexcept {
    return (low.array() <= other.low.array()).all() && (other.high.array() <= high.array()).all();
  }
};

/// Return the smallest boxes, exactly.
inline Bounds bounds_of(const Triangle& t) noexcept {
  return {t[0].cwiseMin(t[1]).cwiseMin(t[2]), t[0].cwiseMax(t[1]).cwiseMax(t[2])};
}
inline Bounds bounds_of(const Segment& s) noexcept {
  return {s.from.cwiseMin(s.to), s.from.cwiseMax(s.to)};
}
inline Bounds united(const Bounds& a, const Bounds& b) noexcept {
  return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high)};
}

/// Returns a box that contains all points within `reach` [length, >= 0] of a box. The rounding
/// error of a sum is at most 2^-53 of the sum. So 2^-52 of the sum is added, which is at least the
/// distance to the next double.
inline Bounds inflated(const Bounds& box, double reach) noexcept {
  const Eigen::Array3d low = box.low.array() - reach;
  const Eigen::Array3d high = box.high.array() + reach;
  return {low - (low.abs() * 0x1p-52 + 1e-300), high + (high.abs() * 0x1p-52 + 1e-300)};
}

/// Bounds of a search: the number of triangles, and the work that is left, one unit for each node
/// (null: unlimited).
struct SearchLimit {
  std::size_t triangles = std::numeric_limits<std::size_t>::max();
  std::uint64_t* work = nullptr;
};

/// Finds the triangles in a region. It is a binary tree of boxes, split at the median center along
/// the longest side. Its depth is log2 n and its size 2 n for any triangles: huge, equal or in one
/// place. It is immutable, so any number of threads may use it.
///
/// Boxes are the exact bounds of their triangles. Each test either consists of comparisons only, or
/// is widened by more than its rounding. So the tree may return extra triangles, but misses none.
class TriangleTree {
 public:
  /// Builds the tree in O(n log n): about 1 s for a million triangles, 64 bytes for each triangle.
  explicit TriangleTree(std::shared_ptr<const Mesh> mesh);

  const Mesh& mesh() const noexcept { return *mesh_; }
  const Bounds& bounds() const noexcept { return nodes_[0].bounds; }

  /// Appends each triangle whose bounds overlap the box, once, in an order that does not depend on
  /// the box.
  void collect(const Bounds& box, std::vector<TriangleId>& out) const;

  /// Appends each triangle that touches the segment once, and perhaps others near it. Precondition:
  /// no coordinate of `to` equals that of `from`.
  void collect_along(const Segment& segment, std::vector<TriangleId>& out) const;

  /// Appends each triangle within `reach` [length, >= 0] of the segment once, and perhaps others.
  /// Returns false if a limit ended the search.
  bool collect_within(double reach, const Segment& segment, std::vector<TriangleId>& out,
                      const SearchLimit& limit = {}) const;

  struct Nearest {
    TriangleId triangle;
    Bracket distance;  // low holds for all triangles; estimate and high for `triangle`
  };
  /// Returns the triangle whose estimated distance from the point is least, with a bracket as
  /// narrow as those of `between`.
  Nearest nearest(const Vec3& point, BracketFunction between) const;

 private:
  struct Node {
    Bounds bounds;
    std::uint32_t next;   // inner: the second child; the first is the node that follows this one
    std::uint32_t first;  // leaf: its triangles are [first, first + count) of order_
    std::uint32_t count;  // inner: 0
  };
  struct Item {
    Vec3 center;
    TriangleId triangle;
  };

  std::uint32_t build(std::vector<Item>& items, std::size_t first, std::size_t count);
  template <class Test>
  bool collect_where(const Test& test, std::vector<TriangleId>& out,
                     const SearchLimit& limit) const;
  void visit_nearest(std::uint32_t node, const Segment& point, BracketFunction between,
                     Nearest& best, double& low) const;

  std::shared_ptr<const Mesh> mesh_;
  std::vector<Node> nodes_;
  std::vector<TriangleId> order_;
};

}  // namespace keepout::monitor
