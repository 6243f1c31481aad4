// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "../../index/tree_parts/triangle_blocks.h"
#include "keepout/mesh/adjacency.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// The places on a triangle in a leaf block where a point may lie, apart from the face. Places 0,
/// 1, 2 are corners, and 3, 4, 5 the insides of sides.
inline constexpr std::size_t places = 6;

/// The corners at either end of each place.
inline constexpr std::array<std::array<std::size_t, 2>, places> corners_at{
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}}};

/// The sides that meet at each place. Inside a side the second entry has no meaning.
inline constexpr std::array<std::array<std::size_t, 2>, places> sides_at{
    {{0, 2}, {0, 1}, {1, 2}, {0, 0}, {1, 1}, {2, 2}}};

/// Data on what is across the sides of the sixteen triangles of a leaf block, for the rule `paper`.
struct alignas(64) LeafEdges {
  /// The unit normal of the triangle; zero if it has no area.
  float normal[3][LeafBlock::lanes];  // [axis][lane]

  /// The largest distance of a corner or apex from the triangle's first corner, rounded up.
  /// [length]
  float span[LeafBlock::lanes];

  /// Five bits for each place. For each of the two sides that meet there, one bit is set if it is a
  /// ridge, and one if the triangle across has the lower number. The fifth bit is set if a side is
  /// a valley. A ridge is an edge that counts as convex.
  std::uint32_t roles[LeafBlock::lanes];
  static constexpr int role_bits = 5;
  static constexpr std::uint32_t ridge[2] = {1, 4};
  static constexpr std::uint32_t lower[2] = {2, 8};
  static constexpr std::uint32_t valley = 16;

  /// More bits of `roles`. `used`: the lane has a triangle. `sturdy`: neither it nor a triangle
  /// across a ridge is so slim that its rounding in double exceeds that of floats.
  static constexpr std::uint32_t used = std::uint32_t{1} << 30;
  static constexpr std::uint32_t sturdy = std::uint32_t{1} << 31;

  /// The corner of the triangle across a ridge that is not on the ridge, rounded to float like the
  /// corners of the block. For any other side: the triangle's first corner. [length]
  float apex[3][3][LeafBlock::lanes];  // [side][axis][lane]
};

/// Returns the data of a leaf. `adjacency`: of the mesh of the leaf. `frame`: of the leaf.
LeafEdges edges_of(const LeafBlock& leaf, const LeafFrame& frame, const Mesh& mesh,
                   const Adjacency& adjacency) noexcept;

}  // namespace keepout
