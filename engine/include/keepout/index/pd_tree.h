// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// The principal direction tree: a binary tree of oriented boxes. The axes of a box are the
/// principal axes of its triangles, which are split along the first axis. Leaves and their tests
/// are those of WideBvh: `collect` returns exactly the triangles that touch the ball.
///
/// Source: Williams, Taylor, Wolff, "Augmented k-d techniques for accelerated registration and
/// distance measurement of surfaces", 1997. Unlike in that article, triangles are split at the
/// median of their centroids instead of the mean. The depth is then logarithmic in the size of any
/// mesh, and all leaves except the last are full.
class PdTree final : public SpatialIndex {
 public:
  /// Capacity of the index.
  static constexpr std::size_t most_triangles = (std::size_t{1} << 31) - 1;

  /// Builds the tree on `threads` threads; 0: as many as there are processors. The tree does not
  /// depend on the number. Throws Error for a mesh of more than most_triangles.
  explicit PdTree(std::shared_ptr<const Mesh> mesh, unsigned threads = 0);

  ~PdTree() override;

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    collect(ball, candidates, nullptr);
  }

  /// Like collect(ball, candidates), but also adds the work of the query to `counts` unless it is
  /// null.
  void collect(const Ball& ball, TriangleBuffer& candidates, QueryCounts* counts) const noexcept;

  const TriangleBlocks* blocks() const noexcept override;

  bool is_exact() const noexcept override { return true; }
  double rounding() const noexcept override;
  std::size_t memory() const noexcept override;

  /// The nodes and leaves, defined only in the sources of the engine.
  class Tree;
  /// Returns the nodes and leaves, valid as long as the index lives.
  const Tree& tree() const noexcept { return *tree_; }

 private:
  std::unique_ptr<Tree> tree_;
};

}  // namespace keepout
