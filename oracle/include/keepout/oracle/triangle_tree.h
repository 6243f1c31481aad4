// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "keepout/ids.h"
#include "keepout/mesh/mesh.h"
#include "keepout/oracle/distance.h"

namespace keepout::oracle {

/// An axis-aligned box. [length]
struct Bounds {
  Vec3 low;
  Vec3 high;

  /// Boxes that touch overlap. Exact: comparisons only.
  bool overlaps(const Bounds& other) const noexcept {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
  bool contains(const Bounds& other) const noexcept {
    return (low.array() <= other.low.array()).all() && (other.high.array() <= high.array()).all();
  }
};

/// The smallest boxes: exact.
inline Bounds bounds_of(const Triangle& t) noexcept {
  return {t[0].cwiseMin(t[1]).cwiseMin(t[2]), t[0].cwiseMax(t[1]).cwiseMax(t[2])};
}
inline Bounds bounds_of(const Segment& s) noexcept {
  return {s.from.cwiseMin(s.to), s.from.cwiseMax(s.to)};
}
inline Bounds united(const Bounds& a, const Bounds& b) noexcept {
  return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high)};
}

/// A box that holds everything within `reach` [length, >= 0] of the box. The sum is rounded, by at
/// most 2^-53 of itself, so 2^-52 of itself, at least the distance to the next double, is added.
inline Bounds inflated(const Bounds& box, double reach) noexcept {
  const Eigen::Array3d low = box.low.array() - reach;
  const Eigen::Array3d high = box.high.array() + reach;
  return {low - (low.abs() * 0x1p-52 + 1e-300), high + (high.abs() * 0x1p-52 + 1e-300)};
}

/// Finds the triangles in some place. A binary tree of boxes, split at the median center along the
/// longest side: its depth is log2 n and its size 2 n whatever the triangles are like, huge, equal
/// or in one place. Immutable, so any number of threads may ask.
///
/// Boxes are the exact bounds of their triangles, and each test is either made of comparisons only
/// or widened by more than its rounding: extras are possible, misses are not.
class TriangleTree {
 public:
  /// O(n log n), about 1 s for a million triangles; 64 bytes a triangle.
  explicit TriangleTree(std::shared_ptr<const Mesh> mesh);

  const Mesh& mesh() const noexcept { return *mesh_; }
  const Bounds& bounds() const noexcept { return nodes_[0].bounds; }

  /// Appends each triangle whose bounds overlap the box, once, in an order of the tree's own that
  /// does not depend on the box.
  void collect(const Bounds& box, std::vector<TriangleId>& out) const;

  /// Appends, once, each triangle that touches the segment, and others close to it.
  /// Precondition: no coordinate of `to` equals that of `from`.
  void collect_along(const Segment& segment, std::vector<TriangleId>& out) const;

  /// Appends, once, each triangle within `reach` [length, >= 0] of the segment, and others farther.
  void collect_within(double reach, const Segment& segment, std::vector<TriangleId>& out) const;

  struct Nearest {
    TriangleId triangle;
    Bracket distance;  // low holds for all triangles; estimate and high are of the one named
  };
  /// The triangle whose estimated distance from the point is least: a narrow bracket, and 0 if and
  /// only if the point is on the mesh.
  Nearest nearest(const Vec3& point) const;

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
  void collect_where(const Test& test, std::vector<TriangleId>& out) const;
  void visit_nearest(std::uint32_t node, const Segment& point, Nearest& best, double& low) const;

  std::shared_ptr<const Mesh> mesh_;
  std::vector<Node> nodes_;
  std::vector<TriangleId> order_;
};

}  // namespace keepout::oracle
