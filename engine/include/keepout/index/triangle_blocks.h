// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "keepout/buffer.h"
#include "keepout/geometry/ball.h"
#include "keepout/index/leaf_block.h"

namespace keepout {

/// Numbers of leaf blocks, with a declared capacity.
using LeafBuffer = Buffer<std::uint32_t>;

/// What an index offers that keeps the triangles of its mesh in leaf blocks, each in one of them: a
/// rule can look at a block as a whole, and remember what it knows of its triangles beside it.
class TriangleBlocks {
 public:
  /// All blocks; what is numbered is their place here.
  virtual std::span<const LeafBlock> leaves() const noexcept = 0;

  /// How far a corner in a leaf may be from the mesh's, in each coordinate. [length]
  virtual double coordinate_error() const noexcept = 0;

  /// Changes with the mesh: what was remembered of another generation holds no more.
  virtual std::uint64_t generation() const noexcept { return 0; }

  /// Appends the number of every leaf with a triangle that touches the ball, once each and in any
  /// order. Extra leaves are allowed, missing ones never. Thread-safe.
  virtual void collect_leaves(const Ball& ball, LeafBuffer& found) const noexcept = 0;

 protected:
  ~TriangleBlocks() = default;

  /// Where the ball is beyond what an index can tell.
  void collect_all_leaves(LeafBuffer& found) const noexcept {
    for (std::uint32_t leaf = 0; leaf < leaves().size(); ++leaf) found.push(leaf);
  }
};

}  // namespace keepout
