// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "../../index/tree_parts/triangle_blocks.h"
#include "keepout/mesh/adjacency.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Where on a triangle in a leaf block a point may lie, but for the face: 0, 1, 2 on its corners,
/// 3, 4, 5 inside its sides.
inline constexpr std::size_t places = 6;

/// The corners at either end of each place.
inline constexpr std::array<std::array<std::size_t, 2>, places> corners_at{
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}}};

/// The sides that meet at each place: the second is of no meaning where there is but one.
inline constexpr std::array<std::array<std::size_t, 2>, places> sides_at{
    {{0, 2}, {0, 1}, {1, 2}, {0, 0}, {1, 1}, {2, 2}}};

/// What lies across the sides of the sixteen triangles of a leaf block: what the paper's rule wants
/// to know besides the block itself.
struct alignas(64) LeafEdges {
  /// The unit normal of the triangle. Zero without an area.
  float normal[3][LeafBlock::lanes];  // [axis][lane]

  /// No farther from the triangle's first corner is any other one, or any apex; rounded up.
  /// [length]
  float span[LeafBlock::lanes];

  /// Five bits for each place, of the sides that meet there: for the first and the second, whether
  /// it is a ridge, and whether the triangle across has the lower number; and whether one is a
  /// valley. A ridge is an edge that counts as convex.
  std::uint32_t roles[LeafBlock::lanes];
  static constexpr int role_bits = 5;
  static constexpr std::uint32_t ridge[2] = {1, 4};
  static constexpr std::uint32_t lower[2] = {2, 8};
  static constexpr std::uint32_t valley = 16;

  /// More bits of `roles`: there is a triangle in the lane; and neither it nor one across a ridge
  /// is so slim that doubles would lose more digits of it than floats have.
  static constexpr std::uint32_t used = std::uint32_t{1} << 30;
  static constexpr std::uint32_t sturdy = std::uint32_t{1} << 31;

  /// The corner that the triangle across a ridge has for itself, rounded to float as those in the
  /// block; across no ridge, the triangle's first corner. [length]
  float apex[3][3][LeafBlock::lanes];  // [side][axis][lane]
};

/// `adjacency` is that of the mesh that the leaf is of, and `frame` that of the leaf.
LeafEdges edges_of(const LeafBlock& leaf, const LeafFrame& frame, const Mesh& mesh,
                   const Adjacency& adjacency) noexcept;

}  // namespace keepout
