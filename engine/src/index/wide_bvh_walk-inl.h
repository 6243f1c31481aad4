// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The walk through a WideBvh, sixteen boxes at a time. Compiled once for each kind of processor.
#if defined(KEEPOUT_INDEX_WIDE_BVH_WALK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KEEPOUT_INDEX_WIDE_BVH_WALK_INL_H
#undef KEEPOUT_INDEX_WIDE_BVH_WALK_INL_H
#else
#define KEEPOUT_INDEX_WIDE_BVH_WALK_INL_H
#endif

#include "keepout/index/wide_bvh.h"
#include "leaf_test-inl.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

/// The children of a node that the ball reaches, if wanted marked where they are all within it.
/// Returns how many, and writes them, and some more, to `reached`.
template <bool marking>
HWY_INLINE std::size_t children_in_reach(const NodeBlock& node, const BallScreen& ball,
                                         std::uint32_t* reached) {
  const Floats d;
  const Ids ids;
  const Lanes reach2 = hn::Set(d, ball.box_reach2);
  const Lanes inside2 = hn::Set(d, ball.box_inside2);
  std::size_t count = 0;
  for (std::size_t first = 0; first < NodeBlock::lanes; first += hn::Lanes(d)) {
    Lanes near2 = hn::Zero(d);
    Lanes far2 = hn::Zero(d);
    for (int axis = 0; axis < 3; ++axis) {
      const Lanes low = hn::Load(d, node.low[axis] + first);
      const Lanes high = hn::Load(d, node.high[axis] + first);
      const Lanes below = hn::Set(d, ball.below[axis]);
      const Lanes above = hn::Set(d, ball.above[axis]);
      const Lanes beyond = most(hn::Sub(low, above), hn::Sub(below, high), hn::Zero(d));
      near2 = hn::Add(near2, hn::Mul(beyond, beyond));
      if constexpr (marking) {
        const Lanes across = hn::Max(hn::Sub(above, low), hn::Sub(high, below));
        far2 = hn::Add(far2, hn::Mul(across, across));
      }
    }
    auto child = hn::Load(ids, node.child + first);
    if constexpr (marking) {
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

/// All children of a node, marked as within the ball.
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
HWY_INLINE void walk(const NodeBlock* nodes, const BallScreen& ball, const Visitor& visitor) {
  // Seven levels of sixteen children hold the most triangles there can be.
  std::uint32_t stack[9 * NodeBlock::lanes];
  std::size_t waiting = 0;
  LeafList list;
  stack[waiting++] = 0;
  while (waiting > 0) {
    const std::uint32_t at = stack[--waiting];
    const NodeBlock& node = nodes[at & ~whole_leaf];
    visitor.count_node();
    const bool above_leaves = (node.child[0] & NodeBlock::leaf) != 0;
    if (above_leaves && list.room() < NodeBlock::lanes) list.show(visitor);
    std::uint32_t* to = above_leaves ? list.end() : stack + waiting;
    const std::size_t count = (at & whole_leaf) != 0
                                  ? all_children(node, to)
                                  : children_in_reach<Visitor::wants_whole_leaves>(node, ball, to);
    if (above_leaves) {
      list.grow(count);
    } else {
      for (std::size_t i = 0; i < count; ++i) {
        const auto* lines = reinterpret_cast<const char*>(nodes + (to[i] & ~whole_leaf));
        for (std::size_t line = 0; line < sizeof(NodeBlock); line += 64)
          hwy::Prefetch(lines + line);
      }
      waiting += count;
    }
  }
  list.show(visitor);
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // include guard, one for each target
