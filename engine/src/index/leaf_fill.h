// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/index/leaf_block.h"
#include "keepout/mesh/mesh.h"
#include "median_split.h"

namespace keepout {

/// How far a coordinate of the mesh may be from the float nearest to it; 0 where all are floats.
/// [length]
double float_error(const Mesh& mesh, unsigned threads);

/// The smallest box around the floats of a leaf. [length]
struct FloatBox {
  float low[3];
  float high[3];
};

/// Writes the corners of the triangles, as the mesh has them, to the lanes of leaves whose `source`
/// says which they are. The bits `odd` are set anew. Calls filled(i, box) after leaf i.
template <class Filled>
void fill_leaves(const Mesh& mesh, std::span<LeafBlock> leaves, const Filled& filled) noexcept;

/// The same for one leaf.
FloatBox fill_leaf(const Mesh& mesh, LeafBlock& leaf) noexcept;

/// Has what fill_leaf will read brought nearer: the first some leaves ahead, the second when that
/// has come. A mesh is in an order of its own, so nearly every read would be waited for.
void fetch_corners(const Mesh& mesh, const LeafBlock& leaf) noexcept;
void fetch_vertices(const Mesh& mesh, const LeafBlock& leaf) noexcept;

/// Writes the numbers of the triangles to the lanes of a leaf.
void name_triangles(std::span<const Center> centers, LeafBlock& leaf) noexcept;

template <class Filled>
void fill_leaves(const Mesh& mesh, std::span<LeafBlock> leaves, const Filled& filled) noexcept {
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (i + 4 < leaves.size()) fetch_corners(mesh, leaves[i + 4]);
    if (i + 2 < leaves.size()) fetch_vertices(mesh, leaves[i + 2]);
    filled(i, fill_leaf(mesh, leaves[i]));
  }
}

}  // namespace keepout
