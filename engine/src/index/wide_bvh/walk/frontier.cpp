// SPDX-License-Identifier: BSD-3-Clause
#include "frontier.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "filters.h"

namespace keepout {

namespace {

/// Has a node brought nearer that is to be opened.
void fetch(const NodeBlock& node) noexcept {
  constexpr std::size_t line = 64;
  const char* block = reinterpret_cast<const char*>(&node);
  for (std::size_t at = 0; at < sizeof node; at += line) __builtin_prefetch(block + at);
}

}  // namespace

void Frontier::add(const WideBvh::Tree& tree, std::uint32_t node, std::size_t lane) noexcept {
  const NodeBlock& from = tree.nodes()[node];
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
  places_[size_] = {node, static_cast<std::uint32_t>(lane)};
  ++size_;
}

const CylinderBlock& Frontier::cylinders(const WideBvh::Tree& tree, std::size_t block) noexcept {
  CylinderBlock& its = cylinders_[block];
  if (has_cylinders_[block]) return its;
  has_cylinders_[block] = true;
  its = {};
  const std::size_t first = block * NodeBlock::lanes;
  const std::size_t count = std::min(size_ - first, NodeBlock::lanes);
  for (std::size_t to = 0; to < count; ++to) {
    const auto [node, lane] = places_[first + to];
    const CylinderBlock& from = tree.cylinders()[node];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      its.middle[axis][to] = from.middle[axis][lane];
      its.axis[axis][to] = from.axis[axis][lane];
    }
    its.half_height[to] = from.half_height[lane];
    its.radius[to] = from.radius[lane];
  }
  return its;
}

std::size_t Frontier::gather(const WideBvh::Tree& tree, const Ball& ball) noexcept {
  struct Unopened {
    std::uint32_t node;
    std::size_t lane;
  };
  constexpr std::size_t most_looks = 32;
  std::array<Unopened, most_boxes + NodeBlock::lanes> waiting;  // inner nodes, the largest first
  std::size_t first = 0, last = 0;

  problem_ = ball;
  size_ = 0;
  is_opened_ = true;
  has_cylinders_.fill(false);
  const Vec3 from_origin = ball.center - tree.frame().origin;
  const FloatTip center = float_tip(from_origin);
  const double rounding = 1e-13 * from_origin.lpNorm<1>();
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
        fetch(tree.nodes()[node.child[lane]]);
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
