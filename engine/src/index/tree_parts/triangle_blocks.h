// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "keepout/buffer.h"
#include "keepout/geometry/shapes.h"
#include "keepout/ids.h"

namespace keepout {

/// The frame of the floats of a tree.
struct LeafFrame {
  /// The origin of the frame. It is the mesh's own if the mesh's coordinates are floats, as in STL
  /// files; otherwise the center of its triangles. [length]
  Vec3 origin = Vec3::Zero();
  /// The largest difference between a corner in a leaf and the mesh's, in each coordinate. It is 0
  /// only if both are the same numbers, with the mesh's own origin. [length]
  double error = 0.0;

  /// Returns true if the coordinates are the mesh's own.
  bool is_exact() const noexcept { return error == 0.0; }
};

/// A leaf of a tree: sixteen triangles, coordinate by coordinate, so that one instruction handles
/// all of them. Coordinates are relative to the frame's origin, and rounded to float.
struct alignas(64) LeafBlock {
  /// The number of triangles in a block.
  static constexpr std::size_t lanes = 16;
  /// The bit of `tagged_triangle` that gives the winding.
  static constexpr std::uint32_t odd = std::uint32_t{1} << 31;
  /// The most triangles that the remaining bits can number.
  static constexpr std::size_t most_triangles = odd - 1;

  /// The corners of each triangle in lexicographic order of the mesh's coordinates. Unused lanes
  /// repeat lane 0. [length]
  float corner[3][3][lanes];  // [corner][axis][lane]

  /// The triangle's number. Bit `odd` is set if the order of its corners is an odd permutation of
  /// its winding. Unused lanes come last and have no_triangle.
  std::uint32_t tagged_triangle[lanes];

  /// Returns true if a lane has a triangle.
  bool is_used(std::size_t lane) const noexcept { return tagged_triangle[lane] != no_triangle; }
  /// Returns the triangle's number. Precondition: is_used(lane).
  TriangleId triangle(std::size_t lane) const noexcept { return tagged_triangle[lane] & ~odd; }
};

/// Numbers of leaf blocks, with a declared capacity.
using LeafBuffer = Buffer<std::uint32_t>;

/// The leaf blocks of an index, which contain each triangle of its mesh once. A rule can examine a
/// whole block, and store notes on its triangles beside it.
class TriangleBlocks {
 public:
  /// Returns all blocks; the number of a block is its index here.
  virtual std::span<const LeafBlock> leaves() const noexcept = 0;

  /// Returns the frame of the coordinates.
  virtual const LeafFrame& frame() const noexcept = 0;

  /// Appends the number of every leaf with a triangle that touches the ball, once each and in any
  /// order. Extra leaves are allowed, missing ones never. Thread-safe.
  virtual void collect_leaves(const Ball& ball, LeafBuffer& found) const noexcept = 0;

 protected:
  ~TriangleBlocks() = default;

  /// Appends all leaves, for a ball beyond the range of floats.
  void collect_all_leaves(LeafBuffer& found) const noexcept {
    for (std::uint32_t leaf = 0; leaf < leaves().size(); ++leaf) found.push(leaf);
  }
};

}  // namespace keepout
