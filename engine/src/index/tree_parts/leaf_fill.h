// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "block_memory.h"
#include "keepout/mesh/mesh.h"
#include "median_split.h"
#include "triangle_blocks.h"

namespace keepout {

/// Writes the corners of a mesh's triangles to leaves. A mesh is in an order of its own and each of
/// its vertices is asked for six times, so where they are floats they are put into a table of
/// floats first, four to a cache line. Others are measured from the middle of the triangles, so
/// that neither the origin nor vertices that no triangle uses cost digits.
class LeafFill {
 public:
  /// Goes over the vertices once. `mesh` must outlive this.
  LeafFill(const Mesh& mesh, unsigned threads);

  /// What a leaf's coordinates are to the mesh's.
  const LeafFrame& frame() const noexcept { return frame_; }

  /// Fills leaves first .. last - 1, whose `tagged_triangle` says which triangles are theirs, and
  /// has what those behind them need brought nearer. The bits `odd` are set anew.
  void fill(std::span<LeafBlock> leaves, std::size_t first, std::size_t last) const noexcept;

  /// Never straddles cache lines. [length]
  struct alignas(16) FloatVertex {
    float x[4];  // the last one is not looked at
  };

 private:
  const Mesh& mesh_;
  BlockVector<FloatVertex> vertices_;  // none where the mesh's are no floats
  LeafFrame frame_;
};

/// Writes the numbers of the triangles to the lanes of a leaf.
void name_triangles(std::span<const Center> centers, LeafBlock& leaf) noexcept;

}  // namespace keepout
