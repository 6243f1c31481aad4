// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "keepout/ids.h"

namespace keepout {

/// Sixteen triangles, coordinate by coordinate, so that one instruction looks at all of them: the
/// leaf of our trees. Numbers are the mesh's, rounded to float: the tree knows by how much at most.
struct alignas(64) LeafBlock {
  /// In a block.
  static constexpr std::size_t lanes = 16;
  /// The bit of `source` that tells of the winding.
  static constexpr std::uint32_t odd = std::uint32_t{1} << 31;
  /// That can be told apart by the bits that are left.
  static constexpr std::size_t most_triangles = odd - 1;

  /// The corners of each triangle in lexicographic order of the mesh's coordinates. Unused lanes
  /// repeat lane 0. [length]
  float corner[3][3][lanes];  // [corner][axis][lane]

  /// The triangle's number, with bit `odd` set if the order of its corners is an odd permutation of
  /// its winding. Unused lanes, which are the last ones, hold no_triangle.
  std::uint32_t source[lanes];

  /// Whether there is a triangle in a lane.
  bool is_used(std::size_t lane) const noexcept { return source[lane] != no_triangle; }
  /// The triangle's number. Precondition: is_used(lane).
  TriangleId triangle(std::size_t lane) const noexcept { return source[lane] & ~odd; }
};

}  // namespace keepout
