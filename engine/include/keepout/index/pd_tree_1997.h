// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// The principal direction tree as published, for comparison. It is a binary tree of oriented
/// boxes, each split at the mean of its triangles along their first principal direction. Leaves
/// have a few triangles, which are tested one after the other. It uses double precision, one core
/// and no SIMD. The comparison with PdTree separates the effect of the idea from that of the memory
/// layout. `collect` returns exactly the triangles that touch the ball.
///
/// Source: Williams, Taylor, Wolff, "Augmented k-d techniques for accelerated registration and
/// distance measurement of surfaces", 1997; used by Li et al., "Anatomical Mesh-Based Virtual
/// Fixtures for Surgical Robots", 2020. Neither article gives the number of triangles in a leaf, or
/// the treatment of unbalanced splits. The constants below are keepout's choice.
class PdTree1997 final : public SpatialIndex {
 public:
  /// Capacity of the index; so many triangles have fewer than 2^32 nodes.
  static constexpr std::size_t most_triangles = (std::size_t{1} << 31) - 1;

  /// The most triangles of a leaf.
  static constexpr std::size_t leaf_triangles = 4;

  /// The most levels of nodes, for most_triangles. Splits at the mean may separate a single
  /// triangle again and again. Deeper than twice the levels of a balanced tree, nodes are therefore
  /// split at the median. So the tree is at most three times as deep as a balanced one, and a stack
  /// of fixed size suffices for a traversal.
  static constexpr std::size_t most_levels = 93;

  /// Builds the tree. Throws Error for a mesh of more than most_triangles.
  explicit PdTree1997(std::shared_ptr<const Mesh> mesh);

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override;
  bool is_exact() const noexcept override { return true; }
  std::size_t memory() const noexcept override;

  /// Returns the number of levels of nodes.
  std::size_t levels() const noexcept { return levels_; }

 private:
  class Builder;

  struct Node {
    Eigen::Matrix3d across;     // rows: the principal directions, largest spread first
    Vec3 from;                  // a corner in the box, the origin of low and high [length]
    Vec3 low, high;             // along the directions [length]
    std::uint32_t next;         // the second child (the first follows), or the start in triangles_
    std::uint32_t in_leaf = 0;  // number of triangles; 0 for a node with children
  };

  std::vector<Node> nodes_;  // a parent precedes its children; the first is the root
  std::vector<TriangleId> triangles_;
  std::size_t levels_ = 0;
};

}  // namespace keepout
