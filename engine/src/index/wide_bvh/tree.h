// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "../tree_parts/block_memory.h"
#include "../tree_parts/triangle_blocks.h"
#include "keepout/index/wide_bvh.h"

namespace keepout {

/// Sixteen cylinders, coordinate by coordinate, around the triangles of a node's boxes. A sheet
/// that is not along the axes fills its box badly, and its cylinder well.
struct alignas(64) CylinderBlock {
  /// In a block.
  static constexpr std::size_t lanes = 16;

  float middle[3][lanes];    // [axis][lane] [length]
  float axis[3][lanes];      // of unit length, but for its rounding
  float half_height[lanes];  // along the axis, to either side of the middle [length]
  float radius[lanes];       // [length]
};

/// Sixteen boxes, coordinate by coordinate, and what is in them.
struct alignas(64) NodeBlock {
  /// In a block.
  static constexpr std::size_t lanes = 16;
  /// The bit of `child` that tells a leaf from a node.
  static constexpr std::uint32_t leaf_bit = std::uint32_t{1} << 31;

  /// Hold their triangles, as the mesh has them, rounded outward; from the origin of the tree's
  /// frame. Unused lanes, which are the last ones, hold a box at infinity that nothing reaches.
  /// [length]
  float low[3][lanes];   // [axis][lane]
  float high[3][lanes];  // [axis][lane]

  /// The number of a node; or of a leaf block, with leaf_bit set. Of an unused lane: 0, which is
  /// the root and nobody's child.
  std::uint32_t child[lanes];

  /// Whether there is a box in a lane.
  bool is_used(std::size_t lane) const noexcept { return child[lane] != 0; }
};

/// Prefetches all cache lines of a block that will be needed soon.
template <class Block>
[[gnu::always_inline]] inline void prefetch(const Block& block) noexcept {
  constexpr std::size_t line = 64;
  const char* bytes = reinterpret_cast<const char*>(&block);
  for (std::size_t at = 0; at < sizeof block; at += line) __builtin_prefetch(bytes + at);
}

class LeafFill;

/// The nodes and leaves of a WideBvh.
class WideBvh::Tree final : public TriangleBlocks {
 public:
  /// Allocates the blocks, whose places follow from the number of triangles. Throws Error if there
  /// are more than most_triangles.
  explicit Tree(const WideBvh& index);

  /// Distributes the triangles to the leaves.
  void divide(unsigned threads);
  /// Distributes them in a given order. Precondition: it names each triangle once.
  void divide(std::span<const TriangleId> order) noexcept;
  /// Writes the corners to the leaves, and encloses them in boxes and cylinders.
  void fit(const LeafFill& fill, unsigned threads);

  /// The mesh of the index.
  const Mesh& mesh() const noexcept { return index_.mesh(); }

  /// A parent stands before its children; the first is the root.
  std::span<const NodeBlock> nodes() const noexcept { return nodes_; }
  /// As the nodes number them.
  std::span<const LeafBlock> leaves() const noexcept override { return leaves_; }
  /// Of each node: around what its boxes are around, as its leaves have it.
  std::span<const CylinderBlock> cylinders() const noexcept { return cylinders_; }

  const LeafFrame& frame() const noexcept override { return frame_; }
  void collect_leaves(const Ball& ball, LeafBuffer& found) const noexcept override;

  /// Memory of the blocks. [bytes]
  std::size_t memory() const noexcept;

 private:
  void enclose_leaves(std::size_t self, std::size_t first, std::size_t last) noexcept;
  void enclose_nodes(std::size_t self, std::size_t first, std::size_t last) noexcept;

  const WideBvh& index_;
  BlockVector<NodeBlock> nodes_;          // level by level, the root first
  BlockVector<LeafBlock> leaves_;         // neighbors near each other
  BlockVector<CylinderBlock> cylinders_;  // as nodes_
  LeafFrame frame_;
};

}  // namespace keepout
