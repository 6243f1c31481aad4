// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "keepout/index/block_memory.h"
#include "keepout/index/spatial_index.h"
#include "keepout/index/triangle_blocks.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Sixteen cylinders, coordinate by coordinate: around the triangles of a tree where they make up a
/// sheet, which a box that is not along it holds badly.
struct alignas(64) CylinderBlock {
  /// In a block.
  static constexpr std::size_t lanes = 16;

  float middle[3][lanes];    // [axis][lane] [length]
  float axis[3][lanes];      // of unit length, but for its rounding
  float half_height[lanes];  // along the axis, to either side of the middle [length]
  float radius[lanes];       // [length]
};

class LeafFill;

/// Sixteen boxes, coordinate by coordinate, and what is in them.
struct alignas(64) NodeBlock {
  /// In a block.
  static constexpr std::size_t lanes = 16;
  /// The bit of `child` that tells a leaf from a node.
  static constexpr std::uint32_t leaf = std::uint32_t{1} << 31;

  /// Hold their triangles, as the mesh has them, rounded outward; from the origin of the tree's
  /// frame. Unused lanes, which are the last ones, hold a box at infinity that nothing reaches.
  /// [length]
  float low[3][lanes];   // [axis][lane]
  float high[3][lanes];  // [axis][lane]

  /// The number of a node; or of a leaf block, with bit `leaf` set. Of an unused lane: 0, which is
  /// the root and nobody's child.
  std::uint32_t child[lanes];

  /// Whether there is a box in a lane.
  bool is_used(std::size_t lane) const noexcept { return child[lane] != 0; }
};

/// Our fastest index: a tree of axis-aligned boxes, sixteen to a node and sixteen triangles to a
/// leaf, both laid out for wide instructions. Floats decide where they are sure, within a band of
/// their rounding the exact kernel does: `collect` answers with the triangles that touch the ball
/// and no others.
///
/// The order of a traversal, and of the triangles, is the tree's own; nothing may depend on it.
class WideBvh final : public SpatialIndex, public TriangleBlocks {
 public:
  /// That it can hold.
  static constexpr std::size_t most_triangles = LeafBlock::most_triangles;

  /// Of nodes, one below the other: as many as most_triangles need.
  static constexpr std::size_t most_levels = 8;

  /// Builds with so many threads, 0 being all there are: the tree is the same. Throws Error for a
  /// mesh of more than most_triangles.
  explicit WideBvh(std::shared_ptr<const Mesh> mesh, unsigned threads = 0);

  /// Makes it the index of a mesh whose triangles are the same, of as many vertices that are
  /// elsewhere: in about a tenth of the time of a new one, and nearly as good while neighbours stay
  /// neighbours. Not to be called while others ask. Every motion constraint on it stops its steps
  /// from then on, until it is told to go on with the moved mesh: see MotionConstraint::follow.
  /// Throws Error, and stays as it is, if the corners of a triangle differ, or without a mesh.
  void refit(std::shared_ptr<const Mesh> moved, unsigned threads = 0);

  /// From the order() of an earlier build: the same tree in about a tenth of the time. Whatever the
  /// order, boxes are put around the mesh's triangles, so that none is lost. Throws Error unless it
  /// names each triangle of the mesh once, and as the other constructor does.
  WideBvh(std::shared_ptr<const Mesh> mesh, std::span<const TriangleId> order,
          unsigned threads = 0);

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    collect(ball, candidates, nullptr);
  }

  /// In one walk: what has a box that comes near the segment.
  void collect_near(const Capsule& capsule, TriangleBuffer& candidates) const noexcept override;

  /// The same, and adds to `counts` what it had to look at, unless it is null.
  void collect(const Ball& ball, TriangleBuffer& candidates, QueryCounts* counts) const noexcept;

  /// By branch and bound: however far off the point is, few triangles are asked about.
  TriangleId nearest(const Vec3& point, Budget& budget) const noexcept override;

  /// Through the boxes along the motion, to the first triangle in its way.
  std::unique_ptr<MotionWalk> walk_along_motions(Budget& budget) const override;

  std::unique_ptr<SpatialIndex> refitted(std::shared_ptr<const Mesh> moved) const override;

  void collect_leaves(const Ball& ball, LeafBuffer& found) const noexcept override;
  const TriangleBlocks* blocks() const noexcept override { return this; }

  bool is_exact() const noexcept override { return true; }
  std::size_t memory() const noexcept override;

  /// A parent stands before its children; the first is the root.
  std::span<const NodeBlock> nodes() const noexcept { return nodes_; }

  /// As the nodes number them.
  std::span<const LeafBlock> leaves() const noexcept override { return leaves_; }

  /// Of each node: around what its boxes are around, as its leaves have it.
  std::span<const CylinderBlock> cylinders() const noexcept { return cylinders_; }

  /// The triangles in the order of the leaves: what is left of a build when all that can be made of
  /// the mesh anew is taken away. Allocates.
  std::vector<TriangleId> order() const;

  const LeafFrame& frame() const noexcept override { return frame_; }

 private:
  void require_same_triangles(const Mesh* moved, unsigned threads) const;
  void make_room();
  void fit(const LeafFill& fill, unsigned threads);
  void enclose_leaves(std::size_t self, std::size_t first, std::size_t last) noexcept;
  void enclose_nodes(std::size_t self, std::size_t first, std::size_t last) noexcept;

  BlockVector<NodeBlock> nodes_;          // level by level, the root first
  BlockVector<LeafBlock> leaves_;         // neighbours near each other
  BlockVector<CylinderBlock> cylinders_;  // as nodes_
  LeafFrame frame_;
};

}  // namespace keepout
