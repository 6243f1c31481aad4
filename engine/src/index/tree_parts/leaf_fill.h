// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "block_memory.h"
#include "keepout/mesh/mesh.h"
#include "median_split.h"
#include "triangle_blocks.h"

namespace keepout {

/// The vertices of a leaf's triangles, each once: about 16 in a closed surface.
struct LeafVertices {
  /// The number of vertices in an entry.
  static constexpr std::size_t most = 24;

  VertexId vertex[most];                     // unused entries repeat the first
  std::uint8_t corner[3][LeafBlock::lanes];  // the entries of each triangle's vertices; unused
                                             // lanes repeat lane 0

  /// Collects the vertices of a leaf, whose `tagged_triangle` has the numbers of its triangles.
  void collect(const Corners* triangles, const LeafBlock& leaf) noexcept;

  /// Returns false if the leaf has more vertices. Then no entry is valid.
  bool is_complete() const noexcept { return corner[0][0] == 0; }
};

/// The positions of a leaf's vertices in the frame of the leaves. [length]
struct alignas(64) LeafPoints {
  /// The number of positions, a multiple of the width of any SIMD register.
  static constexpr std::size_t lanes = 32;

  float position[3][lanes];  // [axis][lane]; unused lanes repeat other positions
  bool is_known = false;     // false: use the leaf's corners instead
};

/// Writes the corners of a mesh's triangles to leaves. Coordinates that are floats are stored as
/// they are. Others are stored relative to the middle of the triangles. So neither the origin nor
/// vertices without triangles cost digits.
class LeafFill {
 public:
  /// Reads the vertices once. `mesh` must outlive this object.
  LeafFill(const Mesh& mesh, unsigned threads);

  /// Returns the frame of the leaves.
  const LeafFrame& frame() const noexcept { return frame_; }

  /// Writes leaves first .. last - 1, with the numbers in their `tagged_triangle`, to `to`.
  /// Prefetches the data of the leaves after them.
  void fill(std::span<const LeafBlock> leaves, std::size_t first, std::size_t last,
            LeafBlock* to) const noexcept;

  /// Like fill(leaves, first, last, to), but faster, with the `vertices` of all leaves. Also writes
  /// the positions of the vertices to `points`.
  void fill(std::span<const LeafBlock> leaves, std::size_t first, std::size_t last, LeafBlock* to,
            const LeafVertices* vertices, LeafPoints* points) const noexcept;

 private:
  const Mesh& mesh_;
  LeafFrame frame_;
};

/// Writes the numbers of the triangles to the lanes of a leaf.
void name_triangles(std::span<const Center> centers, LeafBlock& leaf) noexcept;

/// Copies leaves to a tree. `bypass`: without the caches, for a tree that does not fit into them.
void copy_leaves(const LeafBlock* from, std::size_t count, bool bypass, LeafBlock* to) noexcept;

}  // namespace keepout
