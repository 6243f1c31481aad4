// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "keepout/index/wide_bvh.h"
#include "keepout/mesh/adjacency.h"

namespace keepout {

/// The sides of a triangle in a leaf block, by the two corners at their ends.
inline constexpr std::array<std::array<int, 2>, 3> sides{{{0, 1}, {1, 2}, {0, 2}}};

/// Where on a triangle in a leaf block a point may lie, but for the face: 0, 1, 2 on its corners,
/// 3, 4, 5 on its sides.
inline constexpr std::size_t places = 6;

/// The sides that meet at each corner; the other end of both is what a neighbour shares of them.
inline constexpr std::array<std::array<int, 2>, 3> sides_at{{{0, 2}, {0, 1}, {1, 2}}};

/// What lies across the sides of the sixteen triangles of a leaf block: what the paper's rule wants
/// to know besides the block itself.
struct alignas(64) LeafEdges {
  /// The unit normal of the triangle. Zero without an area.
  float normal[3][LeafBlock::lanes];  // [axis][lane]

  /// No farther from the triangle's first corner is any other one, or any apex; rounded up.
  /// [length]
  float span[LeafBlock::lanes];

  /// Four bits for each place, and some of the triangle. Two bits for the corners at either end of
  /// a side, or twice the same corner, by the numbers they have in the triangle's winding.
  std::uint32_t corners[LeafBlock::lanes];
  static constexpr int corner_bits = 4;

  /// Neither the triangle nor one across a ridge is so slim that doubles would lose more digits of
  /// it than floats have.
  static constexpr std::uint32_t sturdy = std::uint32_t{1} << 24;
  static constexpr std::uint32_t used = std::uint32_t{1} << 25;

  /// Five bits for each place, of the sides that meet there: the first one, or the only one, is a
  /// ridge; the triangle across it has the lower number; the same of the second; one is a valley.
  /// A ridge is an edge that counts as convex.
  std::uint32_t roles[LeafBlock::lanes];
  static constexpr int role_bits = 5;
  static constexpr std::uint32_t first_ridge = 1, first_lower = 2;
  static constexpr std::uint32_t second_ridge = 4, second_lower = 8;
  static constexpr std::uint32_t valley = 16;

  /// The corner that the triangle across a ridge has for itself, rounded to float as those in the
  /// block; across no ridge, the triangle's first corner. [length]
  float apex[3][3][LeafBlock::lanes];  // [side][axis][lane]
};

/// One for each leaf of the tree, in its order. `adjacency` is that of the tree's mesh.
std::vector<LeafEdges> edges_of_leaves(const WideBvh& tree, const Adjacency& adjacency);

}  // namespace keepout
