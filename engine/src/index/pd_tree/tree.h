// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "../tree_parts/block_memory.h"
#include "../tree_parts/triangle_blocks.h"
#include "keepout/index/pd_tree.h"

namespace keepout {

/// An oriented box around consecutive leaves, in one cache line.
struct alignas(64) PdNode {
  /// The principal directions of the triangles in the box, largest spread first: orthonormal up to
  /// the rounding of floats. Stored as across[axis][direction], so that the three directions are
  /// together.
  float across[3][3];

  float center[3];  // of the box, from the origin of the tree's frame [length]
  float half[3];    // half of the box's size along each direction, rounded outward [length]

  /// The number of leaves in the box. If it is above 1, the next node contains the first half of
  /// the leaves, rounded down. The node after that node's subtree contains the others.
  std::uint32_t leaves;
};

/// The nodes and leaves of a PdTree.
class PdTree::Tree final : public TriangleBlocks {
 public:
  /// Builds the tree. Throws Error for a mesh of more than most_triangles.
  Tree(const PdTree& index, unsigned threads);

  /// Returns the mesh of the index.
  const Mesh& mesh() const noexcept { return index_.mesh(); }

  /// Returns the nodes: a parent comes before its children, and the root is first.
  std::span<const PdNode> nodes() const noexcept { return nodes_; }
  /// Returns the leaves, in the order of the nodes.
  std::span<const LeafBlock> leaves() const noexcept override { return leaves_; }
  const LeafFrame& frame() const noexcept override { return frame_; }
  void collect_leaves(const Ball& ball, LeafBuffer& found) const noexcept override;

  /// Returns the memory of the nodes and leaves. [bytes]
  std::size_t memory() const noexcept;

 private:
  const PdTree& index_;
  BlockVector<PdNode> nodes_;
  BlockVector<LeafBlock> leaves_;
  LeafFrame frame_;
};

}  // namespace keepout
