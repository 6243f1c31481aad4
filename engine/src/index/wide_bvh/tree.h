// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "../tree_parts/block_memory.h"
#include "../tree_parts/leaf_fill.h"
#include "../tree_parts/triangle_blocks.h"
#include "keepout/index/wide_bvh.h"

namespace keepout {

/// Sixteen cylinders, coordinate by coordinate, around the triangles of a node's boxes. A cylinder
/// encloses an inclined sheet much more closely than a box along the axes.
struct alignas(64) CylinderBlock {
  /// The number of cylinders in a block.
  static constexpr std::size_t lanes = 16;

  float middle[3][lanes];    // [axis][lane] [length]
  float axis[3][lanes];      // of unit length, up to rounding
  float half_height[lanes];  // along the axis, to either side of the middle [length]
  float radius[lanes];       // [length]
};

/// Sixteen boxes, coordinate by coordinate, and their children.
struct alignas(64) NodeBlock {
  /// The number of boxes in a block.
  static constexpr std::size_t lanes = 16;
  /// The bit of `child` that marks a leaf.
  static constexpr std::uint32_t leaf_bit = std::uint32_t{1} << 31;

  /// The corners of the boxes, relative to the origin of the tree's frame. Each box contains the
  /// mesh's triangles, rounded outward. Unused lanes come last, and have a box at infinity that no
  /// query reaches. [length]
  float low[3][lanes];   // [axis][lane]
  float high[3][lanes];  // [axis][lane]

  /// The number of a node, or of a leaf block with leaf_bit set. An unused lane has 0, the root,
  /// which is no child.
  std::uint32_t child[lanes];

  /// Returns true if a lane has a box.
  bool is_used(std::size_t lane) const noexcept { return child[lane] != 0; }
};

/// Prefetches all cache lines of a block that will be needed soon.
template <class Block>
[[gnu::always_inline]] inline void prefetch(const Block& block) noexcept {
  constexpr std::size_t line = 64;
  const char* bytes = reinterpret_cast<const char*>(&block);
  for (std::size_t at = 0; at < sizeof block; at += line) __builtin_prefetch(bytes + at);
}

/// The nodes and leaves of a WideBvh.
class WideBvh::Tree final : public TriangleBlocks {
 public:
  /// Allocates the blocks, whose places follow from the number of triangles. Throws Error for more
  /// than most_triangles.
  explicit Tree(const WideBvh& index);

  /// Distributes the triangles to the leaves.
  void divide(unsigned threads);
  /// Distributes the triangles in a given order. Precondition: it names each triangle once.
  void divide(std::span<const TriangleId> order) noexcept;
  /// Collects the vertices of each leaf, so that each later fit() is faster. Takes a fifth more
  /// memory.
  void collect_vertices(unsigned threads);
  /// Writes the corners to the leaves, and encloses them in boxes and cylinders.
  void fit(const LeafFill& fill, unsigned threads);

  /// Returns the mesh of the index.
  const Mesh& mesh() const noexcept { return index_.mesh(); }

  /// Returns the nodes: a parent comes before its children, and the root is first.
  std::span<const NodeBlock> nodes() const noexcept { return nodes_; }
  /// Returns the leaves, as the nodes number them.
  std::span<const LeafBlock> leaves() const noexcept override { return leaves_; }
  /// Returns the cylinders of each node, around the same triangles as its boxes.
  std::span<const CylinderBlock> cylinders() const noexcept { return cylinders_; }

  const LeafFrame& frame() const noexcept override { return frame_; }
  void collect_leaves(const Ball& ball, LeafBuffer& found) const noexcept override;

  /// Returns the memory of the blocks. [bytes]
  std::size_t memory() const noexcept;

 private:
  void fit_leaves(const LeafFill& fill, std::span<const LeafBlock> leaves, std::size_t self,
                  std::size_t first, std::size_t last) noexcept;
  void enclose_nodes(std::size_t self, std::size_t first, std::size_t last) noexcept;

  const WideBvh& index_;
  BlockVector<NodeBlock> nodes_;          // level by level, the root first
  BlockVector<LeafBlock> leaves_;         // neighbors near each other
  BlockVector<CylinderBlock> cylinders_;  // in the order of nodes_
  BlockVector<LeafVertices> vertices_;    // of the leaves, after collect_vertices()
  LeafFrame frame_;
};

}  // namespace keepout
