// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "keepout/buffer.h"
#include "keepout/geometry/shapes.h"
#include "keepout/ids.h"

namespace keepout {

/// The frame of a tree's floats.
struct LeafFrame {
  /// Their origin: the mesh's own if its coordinates are floats already, as those of STL files are;
  /// else the center of its triangles. [length]
  Vec3 origin = Vec3::Zero();
  /// The largest difference of a corner in a leaf from the mesh's, in each coordinate; 0 only if
  /// they are the same numbers, with the mesh's own origin. [length]
  double error = 0.0;

  /// Whether the coordinates are the mesh's own.
  bool is_exact() const noexcept { return error == 0.0; }
};

/// Sixteen triangles, coordinate by coordinate, so that one instruction looks at all of them: the
/// leaf of our trees. Numbers are the mesh's, from the frame's origin, rounded to float.
struct alignas(64) LeafBlock {
  /// In a block.
  static constexpr std::size_t lanes = 16;
  /// The bit of `tagged_triangle` that gives the winding.
  static constexpr std::uint32_t odd = std::uint32_t{1} << 31;
  /// That can be told apart by the bits that are left.
  static constexpr std::size_t most_triangles = odd - 1;

  /// The corners of each triangle in lexicographic order of the mesh's coordinates. Unused lanes
  /// repeat lane 0. [length]
  float corner[3][3][lanes];  // [corner][axis][lane]

  /// The triangle's number, with bit `odd` set if the order of its corners is an odd permutation of
  /// its winding. Unused lanes, which are the last ones, hold no_triangle.
  std::uint32_t tagged_triangle[lanes];

  /// Whether there is a triangle in a lane.
  bool is_used(std::size_t lane) const noexcept { return tagged_triangle[lane] != no_triangle; }
  /// The triangle's number. Precondition: is_used(lane).
  TriangleId triangle(std::size_t lane) const noexcept { return tagged_triangle[lane] & ~odd; }
};

/// Numbers of leaf blocks, with a declared capacity.
using LeafBuffer = Buffer<std::uint32_t>;

/// The leaf blocks of an index, which contain each triangle of its mesh once: a rule can examine a
/// block as a whole, and store notes on its triangles beside it.
class TriangleBlocks {
 public:
  /// All blocks; what is numbered is their place here.
  virtual std::span<const LeafBlock> leaves() const noexcept = 0;

  /// Returns the frame of their coordinates.
  virtual const LeafFrame& frame() const noexcept = 0;

  /// Appends the number of every leaf with a triangle that touches the ball, once each and in any
  /// order. Extra leaves are allowed, missing ones never. Thread-safe.
  virtual void collect_leaves(const Ball& ball, LeafBuffer& found) const noexcept = 0;

 protected:
  ~TriangleBlocks() = default;

  /// Appends all leaves: for a ball that is out of the range of floats.
  void collect_all_leaves(LeafBuffer& found) const noexcept {
    for (std::uint32_t leaf = 0; leaf < leaves().size(); ++leaf) found.push(leaf);
  }
};

}  // namespace keepout
