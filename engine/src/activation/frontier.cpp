// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "frontier.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "box_screen.h"

namespace keepout {

void Frontier::add(const WideBvh& tree, std::uint32_t node, std::size_t lane) noexcept {
  const NodeBlock& from = tree.nodes()[node];
  const CylinderBlock& its_cylinders = tree.cylinders()[node];
  NodeBlock& block = blocks_[size_ / NodeBlock::lanes];
  CylinderBlock& cylinders = cylinders_[size_ / NodeBlock::lanes];
  const std::size_t to = size_ % NodeBlock::lanes;
  if (to == 0) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (float& x : block.low[axis]) x = std::numeric_limits<float>::infinity();
      for (float& x : block.high[axis]) x = std::numeric_limits<float>::infinity();
    }
    for (std::uint32_t& child : block.child) child = 0;
    cylinders = {};
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    block.low[axis][to] = from.low[axis][lane];
    block.high[axis][to] = from.high[axis][lane];
    cylinders.middle[axis][to] = its_cylinders.middle[axis][lane];
    cylinders.axis[axis][to] = its_cylinders.axis[axis][lane];
  }
  cylinders.half_height[to] = its_cylinders.half_height[lane];
  cylinders.radius[to] = its_cylinders.radius[lane];
  block.child[to] = from.child[lane];
  ++size_;
}

std::size_t Frontier::gather(const WideBvh& tree, const Ball& ball) noexcept {
  struct Unopened {
    std::uint32_t node;
    std::size_t lane;
  };
  constexpr std::size_t most_looks = 32;
  std::array<Unopened, most_boxes + NodeBlock::lanes> waiting;  // inner nodes, the largest first
  std::size_t first = 0, last = 0;

  around_ = ball;
  size_ = 0;
  is_opened_ = true;
  const FloatTip center = float_tip(ball.center);
  const double rounding = 1e-13 * ball.center.lpNorm<1>();
  const auto radius = static_cast<float>(ball.radius * (1.0 + 4e-6) + rounding);
  std::size_t looks = 0;
  const auto open = [&](std::uint32_t number) {
    const NodeBlock& node = tree.nodes()[number];
    ++looks;
    for (std::uint32_t near = boxes_near(node, center, radius); near != 0; near &= near - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(near));
      if (!node.is_used(lane)) break;
      if ((node.child[lane] & NodeBlock::leaf) != 0) {
        add(tree, number, lane);
      } else {
        __builtin_prefetch(&tree.nodes()[node.child[lane]]);
        waiting[last++] = {number, lane};
      }
    }
  };
  open(0);
  while (first < last) {
    const bool fits = size_ + (last - first) + NodeBlock::lanes <= most_boxes &&
                      last + NodeBlock::lanes <= waiting.size() && looks < most_looks;
    const Unopened box = waiting[first++];
    if (fits) {
      open(tree.nodes()[box.node].child[box.lane]);
    } else {
      is_opened_ = false;
      add(tree, box.node, box.lane);
    }
  }
  double free = ball.radius;
  for (const NodeBlock& block : blocks()) {
    free = std::min(free, double{distance_to_boxes(block, center)} - rounding);
  }
  free_radius_ = free * (1.0 - 1e-12);
  return looks;
}

}  // namespace keepout
