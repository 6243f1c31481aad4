// SPDX-License-Identifier: BSD-3-Clause
#include "../tree.h"
#include "keepout/index/brute_force.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "index/wide_bvh/query/ball.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "../../tree_parts/leaf_test-inl.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

/// Finds the children of a node that the ball reaches. If `marking`, marks those that are entirely
/// within the ball. Writes them, and some more, to `reached`, and returns their number.
template <bool marking>
HWY_INLINE std::size_t children_in_reach(const NodeBlock& node, const BallScreen& ball,
                                         std::uint32_t* reached) {
  const FloatTag d;
  const Ids ids;
  const V reach2 = hn::Set(d, ball.box_reach2);
  const V inside2 = hn::Set(d, ball.box_inside2);
  std::size_t count = 0;
  for (std::size_t first = 0; first < NodeBlock::lanes; first += hn::Lanes(d)) {
    const V near2 = box_distance2(node.low, node.high, first, ball);
    auto child = hn::Load(ids, node.child + first);
    if constexpr (marking) {
      V far2 = hn::Zero(d);
      for (int axis = 0; axis < 3; ++axis) {
        const V to_low = hn::Sub(hn::Set(d, ball.above[axis]), hn::Load(d, node.low[axis] + first));
        const V to_high =
            hn::Sub(hn::Load(d, node.high[axis] + first), hn::Set(d, ball.below[axis]));
        const V farthest = hn::Max(to_low, to_high);
        far2 = hn::Add(far2, hn::Mul(farthest, farthest));
      }
      const auto inside = hn::RebindMask(ids, hn::Le(far2, inside2));
      child = hn::IfThenElse(inside, hn::Or(child, hn::Set(ids, whole_leaf)), child);
    }
    const auto hit = hn::RebindMask(ids, hn::Le(near2, reach2));
    const LanePacking packing(hit);
    hn::StoreU(packing(child), ids, reached + count);
    count += packing.count();
  }
  return count;
}

/// Writes all children of a node, marked as within the ball. Returns their number.
HWY_INLINE std::size_t all_children(const NodeBlock& node, std::uint32_t* children) {
  const Ids ids;
  std::size_t count = 0;
  for (std::size_t first = 0; first < NodeBlock::lanes; first += hn::Lanes(ids)) {
    const auto child = hn::Load(ids, node.child + first);
    hn::StoreU(hn::Or(child, hn::Set(ids, whole_leaf)), ids, children + count);
    count += hn::CountTrue(ids, hn::Ne(child, hn::Zero(ids)));
  }
  return count;
}

/// Shows a visitor the leaves that the ball reaches.
template <class Visitor>
HWY_INLINE void traversal(const NodeBlock* nodes, const BallScreen& ball, const Visitor& visitor) {
  std::uint32_t stack[(WideBvh::most_levels + 1) * NodeBlock::lanes];
  std::size_t waiting = 0;
  LeafList list;
  stack[waiting++] = 0;
  while (waiting > 0 && !visitor.is_full()) {
    const std::uint32_t at = stack[--waiting];
    const NodeBlock& node = nodes[at & ~whole_leaf];
    visitor.count_node();
    const bool above_leaves = (node.child[0] & NodeBlock::leaf_bit) != 0;
    if (above_leaves && list.room() < NodeBlock::lanes) list.show(visitor);
    std::uint32_t* to = above_leaves ? list.end() : stack + waiting;
    const std::size_t count = (at & whole_leaf) != 0
                                  ? all_children(node, to)
                                  : children_in_reach<Visitor::wants_whole_leaves>(node, ball, to);
    if (above_leaves) {
      list.grow(count);
    } else {
      for (std::size_t i = 0; i < count; ++i) {
        prefetch(nodes[to[i] & ~whole_leaf]);
      }
      waiting += count;
    }
  }
  list.show(visitor);
}

void traverse_wide_bvh(const NodeBlock* nodes, const LeafBlock* leaves, const Mesh& mesh,
                       const BallScreen& ball, TriangleBuffer& out) {
  traversal(nodes, ball, TouchingTriangles<false>{leaves, mesh, ball, out, nullptr});
}

void traverse_and_count(const NodeBlock* nodes, const LeafBlock* leaves, const Mesh& mesh,
                        const BallScreen& ball, TriangleBuffer& out, QueryCounts& counts) {
  traversal(nodes, ball, TouchingTriangles<true>{leaves, mesh, ball, out, &counts});
}

void traverse_to_leaves(const NodeBlock* nodes, const BallScreen& ball, LeafBuffer& found) {
  traversal(nodes, ball, TouchedLeaves{found});
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(traverse_wide_bvh);
HWY_EXPORT(traverse_and_count);
HWY_EXPORT(traverse_to_leaves);

void WideBvh::collect(const Ball& ball, TriangleBuffer& candidates,
                      QueryCounts* counts) const noexcept {
  const BallScreen screen(ball, mesh().bounds(), tree_->frame());
  if (!screen.fits) {
    if (counts != nullptr) counts->triangles += mesh().triangle_count();
    return BruteForce(shared_mesh()).collect(ball, candidates);
  }
  if (counts != nullptr) {
    HWY_DYNAMIC_DISPATCH(traverse_and_count)
    (tree_->nodes().data(), tree_->leaves().data(), mesh(), screen, candidates, *counts);
  } else {
    HWY_DYNAMIC_DISPATCH(traverse_wide_bvh)
    (tree_->nodes().data(), tree_->leaves().data(), mesh(), screen, candidates);
  }
}

void WideBvh::Tree::collect_leaves(const Ball& ball, LeafBuffer& found) const noexcept {
  const BallScreen screen(ball, mesh().bounds(), frame_);
  if (!screen.fits) return collect_all_leaves(found);
  HWY_DYNAMIC_DISPATCH(traverse_to_leaves)(nodes_.data(), screen, found);
}

}  // namespace keepout

#endif  // HWY_ONCE
