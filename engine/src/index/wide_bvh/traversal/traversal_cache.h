// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "../tree.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

/// A traversal cache: the parts of a tree near a place, as blocks of boxes like its nodes. Searches
/// near that place start there instead of at the root. A tip moves little from cycle to cycle, so a
/// cache serves many cycles. It also knows that the ball up to the nearest box has no triangle. The
/// cache changes the work units that a traversal spends, so it changes an answer only if the budget
/// ends.
class TraversalCache {
 public:
  static constexpr std::size_t most_blocks = 4;
  static constexpr std::size_t most_boxes = most_blocks * NodeBlock::lanes;

  /// Returns true if the boxes contain all triangles in the ball.
  bool covers(const Ball& ball) const noexcept {
    return (ball.center - covered_.center).norm() + ball.radius <= covered_.radius;
  }

  /// Returns true if the ball is known to contain no triangle.
  bool holds_nothing(const Ball& ball) const noexcept {
    return (ball.center - covered_.center).norm() + ball.radius <= empty_radius_;
  }

  /// Returns true if the ball overlaps the covered one, so the tip has moved and not jumped.
  bool is_near(const Ball& ball) const noexcept {
    return (ball.center - covered_.center).norm() <= covered_.radius + ball.radius;
  }

  /// Covers a ball. Opens at most 32 nodes, which cost no work units; the others remain as large
  /// unopened boxes.
  void cover(const WideBvh::Tree& tree, const Ball& ball) noexcept;

  std::span<const NodeBlock> blocks() const noexcept {
    return {blocks_.data(), (size_ + NodeBlock::lanes - 1) / NodeBlock::lanes};
  }

  /// Returns the cylinders of a block's boxes. The first call copies them from the tree; few cycles
  /// need them.
  const CylinderBlock& cylinders(const WideBvh::Tree& tree, std::size_t block) noexcept;

  std::size_t size() const noexcept { return size_; }

  /// Returns true if all boxes are boxes of leaves, so none was left unopened.
  bool is_opened() const noexcept { return is_opened_; }

 private:
  /// The place of a box in the tree.
  struct Place {
    std::uint32_t node;
    std::uint32_t lane;
  };

  void add(const WideBvh::Tree& tree, std::uint32_t node, std::size_t lane) noexcept;

  Ball covered_{Vec3::Zero(), -1.0};
  double empty_radius_ = -1.0;  // radius of a ball without boxes, around the same center [length]
  bool is_opened_ = true;
  std::size_t size_ = 0;  // boxes
  std::array<NodeBlock, most_blocks> blocks_;
  std::array<Place, most_boxes> places_;              // of the boxes
  std::array<CylinderBlock, most_blocks> cylinders_;  // of the blocks that have them
  std::array<bool, most_blocks> has_cylinders_{};
};

}  // namespace keepout
