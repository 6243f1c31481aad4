// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// The principal direction tree: a binary tree of oriented boxes, the frame of each being the
/// principal axes of its triangles, split along the first of them. Its leaves are those of WideBvh,
/// and tested as they are: `collect` answers with the triangles that touch the ball and no others.
///
/// Source: Williams, Taylor, Wolff, "Augmented k-d techniques for accelerated registration and
/// distance measurement of surfaces", 1997. Split at the median of the triangle centroids instead
/// of at their mean, so that the depth is bounded by the logarithm of the size, whatever the mesh,
/// and all leaves but the last are full.
class PdTree final : public SpatialIndex {
 public:
  /// That it can hold.
  static constexpr std::size_t most_triangles = (std::size_t{1} << 31) - 1;

  /// Builds with so many threads, 0 being all there are: the tree is the same. Throws Error for a
  /// mesh of more than most_triangles.
  explicit PdTree(std::shared_ptr<const Mesh> mesh, unsigned threads = 0);

  ~PdTree() override;

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    collect(ball, candidates, nullptr);
  }

  /// The same, and adds to `counts` what it had to look at, unless it is null.
  void collect(const Ball& ball, TriangleBuffer& candidates, QueryCounts* counts) const noexcept;

  const TriangleBlocks* blocks() const noexcept override;

  bool is_exact() const noexcept override { return true; }
  double rounding() const noexcept override;
  std::size_t memory() const noexcept override;

  /// Nodes and leaves, which only the engine's own sources can look into.
  class Tree;
  /// Lives as long as the index.
  const Tree& tree() const noexcept { return *tree_; }

 private:
  std::unique_ptr<Tree> tree_;
};

}  // namespace keepout
