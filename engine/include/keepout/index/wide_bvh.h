// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// keepout's fastest index, a bounding volume hierarchy (BVH) of axis-aligned boxes. It has sixteen
/// boxes per node and sixteen triangles per leaf, in a layout for SIMD. Single precision decides
/// first. If its rounding leaves a doubt, the exact kernel decides. So `collect` returns exactly
/// the triangles that touch the ball.
///
/// The order of a traversal and of the returned triangles is not specified. Results must not depend
/// on it.
class WideBvh final : public SpatialIndex {
 public:
  /// Capacity of the index.
  static constexpr std::size_t most_triangles = (std::size_t{1} << 31) - 1;

  /// The most levels of nodes, for most_triangles.
  static constexpr std::size_t most_levels = 8;

  /// Builds the tree on `threads` threads; 0: as many as there are processors. The tree does not
  /// depend on the number. Throws Error for a mesh of more than most_triangles.
  explicit WideBvh(std::shared_ptr<const Mesh> mesh, unsigned threads = 0);

  /// Refits the index to a mesh with the same triangles and moved vertices, in about a tenth of the
  /// time of a build. The first call takes longer, and allocates 9 bytes per triangle for later
  /// calls. The tree is nearly as good if neighbors stay neighbors. No other thread may use the
  /// index during the call. Every motion constraint on the index then returns mesh_changed until
  /// MotionConstraint::follow. Throws Error, and changes nothing, if the corners of a triangle
  /// differ, or without a mesh.
  void refit(std::shared_ptr<const Mesh> moved, unsigned threads = 0);

  /// Builds the tree from the order() of an earlier build, in about a tenth of the time. Boxes
  /// enclose the mesh's triangles in any order, so no triangle is lost. Throws Error unless `order`
  /// names each triangle of the mesh once, and like the constructor above.
  WideBvh(std::shared_ptr<const Mesh> mesh, std::span<const TriangleId> order,
          unsigned threads = 0);

  ~WideBvh() override;

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    collect(ball, candidates, nullptr);
  }

  /// Appends the triangles of all boxes near the segment, in one traversal.
  void collect_near(const Capsule& capsule, TriangleBuffer& candidates) const noexcept override;

  /// Like collect(ball, candidates), but also adds the work of the query to `counts` unless it is
  /// null.
  void collect(const Ball& ball, TriangleBuffer& candidates, QueryCounts* counts) const noexcept;

  /// Finds the nearest triangle by branch and bound: examines few triangles at any distance.
  TriangleId nearest(const Vec3& point, Budget& budget) const noexcept override;

  /// Returns a traversal of the boxes along the motion, up to the first triangle in its way.
  std::unique_ptr<MotionTraversal> traverse_along_motions(Budget& budget) const override;
  bool traverses() const noexcept override { return true; }

  std::unique_ptr<SpatialIndex> refitted(std::shared_ptr<const Mesh> moved) const override;

  const TriangleBlocks* blocks() const noexcept override;
  bool is_exact() const noexcept override { return true; }
  double rounding() const noexcept override;
  std::size_t memory() const noexcept override;

  /// Returns the triangles in the order of the leaves; with the mesh, it defines the tree.
  /// Allocates.
  std::vector<TriangleId> order() const;

  /// The nodes and leaves, defined only in the sources of the engine.
  class Tree;
  /// Returns the nodes and leaves, valid as long as the index lives.
  const Tree& tree() const noexcept { return *tree_; }

 private:
  void require_same_triangles(const Mesh* moved, unsigned threads) const;

  std::unique_ptr<Tree> tree_;
};

}  // namespace keepout
