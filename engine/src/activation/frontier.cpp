// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "frontier.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "segment_screen.h"

namespace keepout {

void Frontier::add(const NodeBlock& from, std::size_t lane) noexcept {
  NodeBlock& block = blocks_[size_ / NodeBlock::lanes];
  const std::size_t to = size_ % NodeBlock::lanes;
  if (to == 0) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (float& x : block.low[axis]) x = std::numeric_limits<float>::infinity();
      for (float& x : block.high[axis]) x = std::numeric_limits<float>::infinity();
    }
    for (std::uint32_t& child : block.child) child = 0;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    block.low[axis][to] = from.low[axis][lane];
    block.high[axis][to] = from.high[axis][lane];
  }
  block.child[to] = from.child[lane];
  ++size_;
}

std::size_t Frontier::gather(const WideBvh& tree, const Ball& ball) noexcept {
  struct Unopened {
    const NodeBlock* block;
    std::size_t lane;
  };
  constexpr std::size_t most_looks = 32;
  std::array<Unopened, most_boxes + NodeBlock::lanes> waiting;  // inner nodes, the largest first
  std::size_t first = 0, last = 0;

  around_ = ball;
  size_ = 0;
  const FloatTip center = float_tip(ball.center);
  const double rounding = 1e-13 * ball.center.lpNorm<1>();
  const auto radius = static_cast<float>(ball.radius * (1.0 + 4e-6) + rounding);
  std::size_t looks = 0;
  const auto open = [&](const NodeBlock& node) {
    ++looks;
    for (std::uint32_t near = boxes_near(node, center, radius); near != 0; near &= near - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(near));
      if (!node.is_used(lane)) break;
      if ((node.child[lane] & NodeBlock::leaf) != 0) {
        add(node, lane);
      } else {
        __builtin_prefetch(&tree.nodes()[node.child[lane]]);
        waiting[last++] = {&node, lane};
      }
    }
  };
  open(tree.nodes().front());
  while (first < last) {
    const bool fits = size_ + (last - first) + NodeBlock::lanes <= most_boxes &&
                      last + NodeBlock::lanes <= waiting.size() && looks < most_looks;
    const Unopened box = waiting[first++];
    if (fits) {
      open(tree.nodes()[box.block->child[box.lane]]);
    } else {
      add(*box.block, box.lane);
    }
  }
  free_radius_ = std::min(distance_to_boxes(), ball.radius) * (1.0 - 1e-12);
  return looks;
}

/// From the centre; infinite where there are none. [length]
double Frontier::distance_to_boxes() const noexcept {
  double least2 = std::numeric_limits<double>::infinity();
  for (std::size_t box = 0; box < size_; ++box) {
    const NodeBlock& block = blocks_[box / NodeBlock::lanes];
    const std::size_t lane = box % NodeBlock::lanes;
    double distance2 = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double before = block.low[axis][lane] - around_.center[axis];
      const double beyond = around_.center[axis] - block.high[axis][lane];
      const double apart = std::max({before, beyond, 0.0});
      distance2 += apart * apart;
    }
    least2 = std::min(least2, distance2);
  }
  return std::sqrt(least2);
}

}  // namespace keepout
