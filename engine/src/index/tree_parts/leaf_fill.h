// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "block_memory.h"
#include "keepout/mesh/mesh.h"
#include "median_split.h"
#include "triangle_blocks.h"

namespace keepout {

/// The vertices of a leaf's triangles. Unused lanes repeat lane 0.
using LeafCorners = std::array<Corners, LeafBlock::lanes>;

/// Looks up the vertices of a leaf, whose `tagged_triangle` has the numbers of its triangles.
inline void look_up(const Corners* triangles, const LeafBlock& leaf,
                    LeafCorners& corners) noexcept {
  const bool is_full = leaf.is_used(LeafBlock::lanes - 1);
  for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
    corners[lane] = triangles[leaf.triangle(is_full || leaf.is_used(lane) ? lane : 0)];
  }
}

/// Writes the corners of a mesh's triangles to leaves. Coordinates that are floats are stored as
/// they are. Others are stored relative to the middle of the triangles. So neither the origin nor
/// vertices without triangles cost digits.
class LeafFill {
 public:
  /// Reads the vertices once. `mesh` must outlive this object.
  LeafFill(const Mesh& mesh, unsigned threads);

  /// Returns the frame of the leaves.
  const LeafFrame& frame() const noexcept { return frame_; }

  /// Fills leaves first .. last - 1, whose `tagged_triangle` already has the numbers of their
  /// triangles. `corners`: the vertices of all leaves, or null to look them up. Prefetches the data
  /// of the leaves after them.
  void fill(std::span<LeafBlock> leaves, std::size_t first, std::size_t last,
            const LeafCorners* corners = nullptr) const noexcept;

 private:
  const Mesh& mesh_;
  LeafFrame frame_;
};

/// Writes the numbers of the triangles to the lanes of a leaf.
void name_triangles(std::span<const Center> centers, LeafBlock& leaf) noexcept;

}  // namespace keepout
