// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "keepout/index/block_memory.h"
#include "keepout/index/spatial_index.h"
#include "keepout/index/triangle_blocks.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// An oriented box around consecutive leaves, in one cache line.
struct alignas(64) PdNode {
  /// The principal directions of what is in the box, largest spread first: orthonormal to the
  /// rounding of floats. across[axis][direction], so that the three directions are together.
  float across[3][3];

  float center[3];  // of the box, from the origin of the tree's frame [length]
  float half[3];    // half of the box's size along each direction, rounded outward [length]

  /// How many leaves are in the box. Where more than one, the first half of them, rounded down, is
  /// in the next node, and the others in the one behind that node's subtree.
  std::uint32_t leaves;
};

/// The principal direction tree: a binary tree of oriented boxes, the frame of each being the
/// principal axes of its triangles, split along the first of them. Its leaves are those of WideBvh,
/// and tested as they are: `collect` answers with the triangles that touch the ball and no others.
///
/// Source: Williams, Taylor, Wolff, "Augmented k-d techniques for accelerated registration and
/// distance measurement of surfaces", 1997. Split at the median of the triangle centroids instead
/// of at their mean, so that the depth is bounded by the logarithm of the size, whatever the mesh,
/// and all leaves but the last are full.
class PdTree final : public SpatialIndex, public TriangleBlocks {
 public:
  /// That it can hold.
  static constexpr std::size_t most_triangles = LeafBlock::most_triangles;

  /// Builds with so many threads, 0 being all there are: the tree is the same. Throws Error for a
  /// mesh of more than most_triangles.
  explicit PdTree(std::shared_ptr<const Mesh> mesh, unsigned threads = 0);

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    collect(ball, candidates, nullptr);
  }

  /// The same, and adds to `counts` what it had to look at, unless it is null.
  void collect(const Ball& ball, TriangleBuffer& candidates, QueryCounts* counts) const noexcept;

  void collect_leaves(const Ball& ball, LeafBuffer& found) const noexcept override;
  const TriangleBlocks* blocks() const noexcept override { return this; }

  bool is_exact() const noexcept override { return true; }
  std::size_t memory() const noexcept override;

  /// A parent stands before its children; the first is the root.
  std::span<const PdNode> nodes() const noexcept { return nodes_; }

  /// In the order in which the nodes hold them.
  std::span<const LeafBlock> leaves() const noexcept override { return leaves_; }

  const LeafFrame& frame() const noexcept override { return frame_; }

 private:
  BlockVector<PdNode> nodes_;
  BlockVector<LeafBlock> leaves_;
  LeafFrame frame_;
};

}  // namespace keepout
