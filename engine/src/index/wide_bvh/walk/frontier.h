// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "../tree.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

/// The parts of a tree that come near a place, as blocks of boxes like its nodes: a root of its own
/// for searches near there. A tip moves little from cycle to cycle, so one gathering serves many;
/// up to the nearest box it is a ball of free space. What is in it never changes an answer.
class Frontier {
 public:
  /// Whether all that is in the ball is under the boxes.
  bool covers(const Ball& ball) const noexcept {
    return (ball.center - problem_.center).norm() + ball.radius <= problem_.radius;
  }

  /// Whether nothing at all is in the ball.
  bool is_free(const Ball& ball) const noexcept {
    return (ball.center - problem_.center).norm() + ball.radius <= free_radius_;
  }

  /// Whether the ball is next to what is covered: where a tip that moves on leaves.
  bool is_near(const Ball& ball) const noexcept {
    return (ball.center - problem_.center).norm() <= problem_.radius + ball.radius;
  }

  /// Makes it cover the ball. The work is bounded: what is left over stays unopened, as large
  /// boxes. Returns the number of nodes that were looked at.
  std::size_t gather(const WideBvh::Tree& tree, const Ball& ball) noexcept;

  std::span<const NodeBlock> blocks() const noexcept {
    return {blocks_.data(), (size_ + NodeBlock::lanes - 1) / NodeBlock::lanes};
  }

  /// Beside the boxes of a block. Taken from the tree when first asked for, which few cycles do.
  const CylinderBlock& cylinders(const WideBvh::Tree& tree, std::size_t block) noexcept;

  std::size_t size() const noexcept { return size_; }

  /// Whether all of its boxes are those of leaves: none was left unopened.
  bool is_opened() const noexcept { return is_opened_; }

 private:
  static constexpr std::size_t most_blocks = 4;
  static constexpr std::size_t most_boxes = most_blocks * NodeBlock::lanes;

  /// Where a box is in the tree.
  struct Place {
    std::uint32_t node;
    std::uint32_t lane;
  };

  void add(const WideBvh::Tree& tree, std::uint32_t node, std::size_t lane) noexcept;

  Ball problem_{Vec3::Zero(), -1.0};
  double free_radius_ = -1.0;  // around the same centre there are no boxes [length]
  bool is_opened_ = true;
  std::size_t size_ = 0;  // boxes
  std::array<NodeBlock, most_blocks> blocks_;
  std::array<Place, most_boxes> places_;              // of the boxes
  std::array<CylinderBlock, most_blocks> cylinders_;  // of those blocks that have them
  std::array<bool, most_blocks> has_cylinders_{};
};

}  // namespace keepout
