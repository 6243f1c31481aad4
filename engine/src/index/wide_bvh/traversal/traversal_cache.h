// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "../tree.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

/// A traversal cache: the parts of a tree that come near a place, as blocks of boxes like its
/// nodes, a root of its own for searches there. A tip moves little from cycle to cycle, so it
/// serves many of them. The ball up to the nearest box is known to hold no triangle. The cache
/// changes the work units that a traversal spends, so it changes an answer only where the budget
/// ends.
class TraversalCache {
 public:
  static constexpr std::size_t most_blocks = 4;
  static constexpr std::size_t most_boxes = most_blocks * NodeBlock::lanes;

  /// Returns true if all triangles in the ball are under the boxes.
  bool covers(const Ball& ball) const noexcept {
    return (ball.center - covered_.center).norm() + ball.radius <= covered_.radius;
  }

  /// Returns true if the ball is known to hold no triangle.
  bool holds_nothing(const Ball& ball) const noexcept {
    return (ball.center - covered_.center).norm() + ball.radius <= empty_radius_;
  }

  /// Returns true if the ball overlaps the covered one: the tip has moved on, and not jumped.
  bool is_near(const Ball& ball) const noexcept {
    return (ball.center - covered_.center).norm() <= covered_.radius + ball.radius;
  }

  /// Covers a ball. Opens at most 32 nodes, which take no work units; the others stay unopened, as
  /// large boxes.
  void cover(const WideBvh::Tree& tree, const Ball& ball) noexcept;

  std::span<const NodeBlock> blocks() const noexcept {
    return {blocks_.data(), (size_ + NodeBlock::lanes - 1) / NodeBlock::lanes};
  }

  /// Returns the cylinders of a block's boxes. Copied from the tree at the first call, which few
  /// cycles make.
  const CylinderBlock& cylinders(const WideBvh::Tree& tree, std::size_t block) noexcept;

  std::size_t size() const noexcept { return size_; }

  /// Returns true if all of its boxes are those of leaves: none was left unopened.
  bool is_opened() const noexcept { return is_opened_; }

 private:
  /// Where a box is in the tree.
  struct Place {
    std::uint32_t node;
    std::uint32_t lane;
  };

  void add(const WideBvh::Tree& tree, std::uint32_t node, std::size_t lane) noexcept;

  Ball covered_{Vec3::Zero(), -1.0};
  double empty_radius_ = -1.0;  // around the same center there are no boxes [length]
  bool is_opened_ = true;
  std::size_t size_ = 0;  // boxes
  std::array<NodeBlock, most_blocks> blocks_;
  std::array<Place, most_boxes> places_;              // of the boxes
  std::array<CylinderBlock, most_blocks> cylinders_;  // of those blocks that have them
  std::array<bool, most_blocks> has_cylinders_{};
};

}  // namespace keepout
