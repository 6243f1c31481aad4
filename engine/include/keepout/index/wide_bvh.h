// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Our fastest index: a tree of axis-aligned boxes, sixteen to a node and sixteen triangles to a
/// leaf, both laid out for wide instructions. Floats decide where they are sure, within a band of
/// their rounding the exact kernel does: `collect` answers with the triangles that touch the ball
/// and no others.
///
/// The order of a traversal, and of the triangles, is the tree's own; nothing may depend on it.
class WideBvh final : public SpatialIndex {
 public:
  /// That it can hold.
  static constexpr std::size_t most_triangles = (std::size_t{1} << 31) - 1;

  /// Of nodes, one below the other: as many as most_triangles need.
  static constexpr std::size_t most_levels = 8;

  /// Builds with so many threads, 0 being all there are: the tree is the same. Throws Error for a
  /// mesh of more than most_triangles.
  explicit WideBvh(std::shared_ptr<const Mesh> mesh, unsigned threads = 0);

  /// Makes it the index of a mesh whose triangles are the same, of as many vertices that are
  /// elsewhere: in about a tenth of the time of a new one, and nearly as good while neighbors stay
  /// neighbors. Not to be called while others ask. Every motion constraint on it stops its steps
  /// from then on, until it is told to go on with the moved mesh: see MotionConstraint::follow.
  /// Throws Error, and stays as it is, if the corners of a triangle differ, or without a mesh.
  void refit(std::shared_ptr<const Mesh> moved, unsigned threads = 0);

  /// From the order() of an earlier build: the same tree in about a tenth of the time. Whatever the
  /// order, boxes are put around the mesh's triangles, so that none is lost. Throws Error unless it
  /// names each triangle of the mesh once, and as the other constructor does.
  WideBvh(std::shared_ptr<const Mesh> mesh, std::span<const TriangleId> order,
          unsigned threads = 0);

  ~WideBvh() override;

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    collect(ball, candidates, nullptr);
  }

  /// In one traversal: what has a box that comes near the segment.
  void collect_near(const Capsule& capsule, TriangleBuffer& candidates) const noexcept override;

  /// The same, and adds to `counts` what it had to look at, unless it is null.
  void collect(const Ball& ball, TriangleBuffer& candidates, QueryCounts* counts) const noexcept;

  /// By branch and bound: however far off the point is, few triangles are asked about.
  TriangleId nearest(const Vec3& point, Budget& budget) const noexcept override;

  /// Through the boxes along the motion, to the first triangle in its way.
  std::unique_ptr<MotionTraversal> traverse_along_motions(Budget& budget) const override;
  bool traverses() const noexcept override { return true; }

  std::unique_ptr<SpatialIndex> refitted(std::shared_ptr<const Mesh> moved) const override;

  const TriangleBlocks* blocks() const noexcept override;
  bool is_exact() const noexcept override { return true; }
  double rounding() const noexcept override;
  std::size_t memory() const noexcept override;

  /// The triangles in the order of the leaves: what is left of a build when all that can be made of
  /// the mesh anew is taken away. Allocates.
  std::vector<TriangleId> order() const;

  /// Nodes and leaves, which only the engine's own sources can look into.
  class Tree;
  /// Lives as long as the index.
  const Tree& tree() const noexcept { return *tree_; }

 private:
  void require_same_triangles(const Mesh* moved, unsigned threads) const;

  std::unique_ptr<Tree> tree_;
};

}  // namespace keepout
