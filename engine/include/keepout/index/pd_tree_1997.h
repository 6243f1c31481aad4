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

/// The principal direction tree as it was published, for comparison: a binary tree of oriented
/// boxes, each split at the mean of its triangles along their first principal direction, down to
/// leaves of a few triangles, which are tested one after the other. All of it in double, on one
/// core, without wide instructions. PdTree is what became of it here: the two side by side tell
/// what is owed to the idea, and what to how it is laid out. `collect` answers with the triangles
/// that touch the ball and no others.
///
/// Source: Williams, Taylor, Wolff, "Augmented k-d techniques for accelerated registration and
/// distance measurement of surfaces", 1997; taken up by Li et al., "Anatomical Mesh-Based Virtual
/// Fixtures for Surgical Robots", 2020. Neither says how many triangles a leaf has, nor what
/// becomes of a lopsided mesh: the numbers below are ours.
class PdTree1997 final : public SpatialIndex {
 public:
  /// That it can hold: as many as have fewer than 2^32 nodes.
  static constexpr std::size_t most_triangles = (std::size_t{1} << 31) - 1;

  /// In a leaf.
  static constexpr std::size_t leaf_triangles = 4;

  /// Of nodes, one below the other: what most_triangles need. At the mean a mesh may be split into
  /// one triangle and all the others, time and again; below twice the levels of a balanced tree it
  /// is split at the median, so that a tree is at most three times as deep as that and a traversal
  /// needs no more than a fixed piece of stack.
  static constexpr std::size_t most_levels = 93;

  /// Throws Error for a mesh of more than most_triangles.
  explicit PdTree1997(std::shared_ptr<const Mesh> mesh);

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override;
  bool is_exact() const noexcept override { return true; }
  std::size_t memory() const noexcept override;

  /// How many nodes there are one below the other, at most.
  std::size_t levels() const noexcept { return levels_; }

 private:
  class Builder;

  struct Node {
    Eigen::Matrix3d across;     // rows: the principal directions, largest spread first
    Vec3 from;                  // a corner in the box, from which it is measured [length]
    Vec3 low, high;             // along the directions [length]
    std::uint32_t next;         // the second child, the first being the next node; or in triangles_
    std::uint32_t in_leaf = 0;  // triangles; none: it has children
  };

  std::vector<Node> nodes_;  // a parent stands before its children; the first is the root
  std::vector<TriangleId> triangles_;
  std::size_t levels_ = 0;
};

}  // namespace keepout
