// SPDX-License-Identifier: BSD-3-Clause
#include "traversal_cache.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "filters.h"

namespace keepout {

void TraversalCache::add(const WideBvh::Tree& tree, std::uint32_t node, std::size_t lane) noexcept {
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

const CylinderBlock& TraversalCache::cylinders(const WideBvh::Tree& tree,
                                               std::size_t block) noexcept {
  CylinderBlock& copy = cylinders_[block];
  if (has_cylinders_[block]) return copy;
  has_cylinders_[block] = true;
  copy = {};
  const std::size_t first = block * NodeBlock::lanes;
  const std::size_t count = std::min(size_ - first, NodeBlock::lanes);
  for (std::size_t to = 0; to < count; ++to) {
    const auto [node, lane] = places_[first + to];
    const CylinderBlock& from = tree.cylinders()[node];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      copy.middle[axis][to] = from.middle[axis][lane];
      copy.axis[axis][to] = from.axis[axis][lane];
    }
    copy.half_height[to] = from.half_height[lane];
    copy.radius[to] = from.radius[lane];
  }
  return copy;
}

void TraversalCache::cover(const WideBvh::Tree& tree, const Ball& ball) noexcept {
  constexpr std::size_t most_opened = 32;
  std::array<Place, most_boxes + NodeBlock::lanes> waiting;  // inner nodes, the largest first
  std::size_t first = 0, last = 0;

  covered_ = ball;
  size_ = 0;
  is_opened_ = true;
  has_cylinders_.fill(false);
  const Vec3 from_origin = ball.center - tree.frame().origin;
  const FloatTip center = float_tip(from_origin);
  const double rounding = 1e-13 * from_origin.lpNorm<1>();
  const auto radius = static_cast<float>(ball.radius * (1.0 + 4e-6) + rounding);
  std::size_t opened = 0;
  const auto open = [&](std::uint32_t number) {
    const NodeBlock& node = tree.nodes()[number];
    ++opened;
    for (std::uint32_t near = boxes_near(node, center, radius); near != 0; near &= near - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(near));
      if (!node.is_used(lane)) break;
      if ((node.child[lane] & NodeBlock::leaf_bit) != 0) {
        add(tree, number, lane);
      } else {
        prefetch(tree.nodes()[node.child[lane]]);
        waiting[last++] = {number, lane};
      }
    }
  };
  open(0);
  while (first < last) {
    // Sixteen more boxes fit in waiting, and in blocks_ together with all waiting boxes.
    const bool fits = size_ + (last - first) + NodeBlock::lanes <= most_boxes &&
                      last + NodeBlock::lanes <= waiting.size() && opened < most_opened;
    const Place box = waiting[first++];
    if (fits) {
      open(tree.nodes()[box.node].child[box.lane]);
    } else {
      is_opened_ = false;
      add(tree, box.node, box.lane);
    }
  }
  double empty = ball.radius;
  for (const NodeBlock& block : blocks()) {
    empty = std::min(empty, double{distance_to_boxes(block, center)} - rounding);
  }
  empty_radius_ = empty * (1.0 - 1e-12);
}

}  // namespace keepout
