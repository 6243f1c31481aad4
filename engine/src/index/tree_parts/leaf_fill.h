// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "block_memory.h"
#include "keepout/mesh/mesh.h"
#include "median_split.h"
#include "triangle_blocks.h"

namespace keepout {

/// Writes the corners of a mesh's triangles to leaves. The mesh has its own order, and each vertex
/// is read about six times. So vertices that are floats are first copied to a table of floats, four
/// to a cache line. Other vertices are stored relative to the middle of the triangles. So neither
/// the origin nor vertices without triangles cost digits.
class LeafFill {
 public:
  /// Reads the vertices once. `mesh` must outlive this object.
  LeafFill(const Mesh& mesh, unsigned threads);

  /// Returns the frame of the leaves.
  const LeafFrame& frame() const noexcept { return frame_; }

  /// Fills leaves first .. last - 1, whose `tagged_triangle` already has the numbers of their
  /// triangles. Prefetches the data of the leaves after them.
  void fill(std::span<LeafBlock> leaves, std::size_t first, std::size_t last) const noexcept;

  /// A vertex that never crosses a cache line. [length]
  struct alignas(16) FloatVertex {
    float x[4];  // the last is unused
  };

 private:
  const Mesh& mesh_;
  BlockVector<FloatVertex> vertices_;  // empty if the mesh's vertices are not floats
  LeafFrame frame_;
};

/// Writes the numbers of the triangles to the lanes of a leaf.
void name_triangles(std::span<const Center> centers, LeafBlock& leaf) noexcept;

}  // namespace keepout
