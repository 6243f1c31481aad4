// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "keepout/index/brute_force.h"
#include "tree.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "index/pd_tree/query.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which sets the target to compile for.
#include <hwy/highway.h>

#include "../tree_parts/leaf_test-inl.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

/// A ball in floats, for the test against oriented boxes (PdNode).
///
/// The position of the center c in a box's frame is off by at most 8 u |c - center| + A, with u and
/// A of ball_screen.cpp. These are two roundings of the difference, and four of the products and
/// their sum. If a triangle in the box is within the radius r, |c - center| is at most r plus half
/// the box's diagonal. The box was enlarged for the second part. The frame stretches lengths by at
/// most 4 u. Squares and their sum round by 5 u.
struct OrientedScreen {
  explicit OrientedScreen(const BallScreen& ball) noexcept {
    constexpr double band = 0x1p-17;
    std::copy_n(ball.high_part, 3, high_part);
    std::copy_n(ball.low_part, 3, low_part);
    const double off = 2.0 * (ball.off + ball.pad);
    const double reach = std::max(ball.ball.radius, 0.0) + off;
    const double core = ball.ball.radius - off;
    reach2 = at_least(reach * reach * (1.0 + band));
    inside2 = core > 0.0 ? at_most(core * core * (1.0 - band)) : -1.0f;
  }

  float high_part[3];  // the center is high_part + low_part [length]
  float low_part[3];
  float reach2;   // limit of a box's squared distance, beyond which the ball does not reach it
  float inside2;  // limit for the farthest corner, within which all triangles in the box touch the
                  // ball
};

/// The part of a box that is in the ball.
enum class Overlap { none, some, all };

/// Squares for each direction of a box: of how far the ball's center is beyond the box, and of its
/// distance from the box's other side.
struct Squares {
  alignas(16) float beyond[4];  // the last element has no meaning
  alignas(16) float across[4];
};

HWY_INLINE Squares squares(const PdNode& node, const float (&from_center)[3]) {
  Squares of;
#if HWY_TARGET == HWY_SCALAR
  for (int k = 0; k < 3; ++k) {
    const float along =
        std::abs((node.across[0][k] * from_center[0] + node.across[1][k] * from_center[1]) +
                 node.across[2][k] * from_center[2]);
    const float beyond = std::max(along - node.half[k], 0.0f);
    const float across = along + node.half[k];
    of.beyond[k] = beyond * beyond;
    of.across[k] = across * across;
  }
#else
  // All three directions at once. A load of four includes the next number, which has no effect.
  const hn::FixedTag<float, 4> d;
  const auto x = hn::Mul(hn::LoadU(d, node.across[0]), hn::Set(d, from_center[0]));
  const auto y = hn::Mul(hn::LoadU(d, node.across[1]), hn::Set(d, from_center[1]));
  const auto z = hn::Mul(hn::LoadU(d, node.across[2]), hn::Set(d, from_center[2]));
  const auto along = hn::Abs(hn::Add(hn::Add(x, y), z));
  const auto half = hn::LoadU(d, node.half);
  const auto beyond = hn::Max(hn::Sub(along, half), hn::Zero(d));
  const auto across = hn::Add(along, half);
  hn::Store(hn::Mul(beyond, beyond), d, of.beyond);
  hn::Store(hn::Mul(across, across), d, of.across);
#endif
  return of;
}

HWY_INLINE Overlap overlap(const PdNode& node, const OrientedScreen& screen) {
  const float from_center[3] = {(screen.high_part[0] - node.center[0]) + screen.low_part[0],
                                (screen.high_part[1] - node.center[1]) + screen.low_part[1],
                                (screen.high_part[2] - node.center[2]) + screen.low_part[2]};
  const Squares of = squares(node, from_center);
  if ((of.beyond[0] + of.beyond[1]) + of.beyond[2] > screen.reach2) return Overlap::none;
  const bool all = (of.across[0] + of.across[1]) + of.across[2] <= screen.inside2;
  return all ? Overlap::all : Overlap::some;
}

/// Shows a visitor the leaves that the ball reaches.
template <class Visitor>
HWY_NOINLINE void traversal(const PdNode* nodes, const OrientedScreen& screen,
                            const Visitor& visitor) {
  struct Subtree {
    std::uint32_t node;
    std::uint32_t first_leaf;
  };
  // Deeper than any tree: its halves of at most 2^27 leaves differ by one leaf.
  Subtree stack[64];
  std::size_t waiting = 0;
  LeafList list;
  stack[waiting++] = {0, 0};
  while (waiting > 0 && !visitor.is_full()) {
    Subtree at = stack[--waiting];
    while (true) {
      const PdNode& node = nodes[at.node];
      visitor.count_node();
      const Overlap found = overlap(node, screen);
      if (found == Overlap::none) break;
      if (found == Overlap::some && node.leaves > 1) {
        const std::uint32_t near = node.leaves / 2;
        stack[waiting++] = {at.node + 2 * near, at.first_leaf + near};
        hwy::Prefetch(nodes + at.node + 2 * near);
        ++at.node;
        continue;
      }
      const std::uint32_t mark = found == Overlap::all ? whole_leaf : 0;
      for (std::uint32_t i = 0; i < node.leaves; ++i) {
        if (list.room() == 0) list.show(visitor);
        *list.end() = (at.first_leaf + i) | mark;
        list.grow(1);
      }
      break;
    }
  }
  list.show(visitor);
}

void traverse_pd_tree(const PdNode* nodes, const LeafBlock* leaves, const Mesh& mesh,
                      const BallScreen& ball, TriangleBuffer& out, QueryCounts* counts) {
  const OrientedScreen screen(ball);
  if (counts == nullptr) {
    return traversal(nodes, screen, TouchingTriangles<false>{leaves, mesh, ball, out, counts});
  }
  traversal(nodes, screen, TouchingTriangles<true>{leaves, mesh, ball, out, counts});
}

void traverse_pd_tree_to_leaves(const PdNode* nodes, const BallScreen& ball, LeafBuffer& found) {
  traversal(nodes, OrientedScreen(ball), TouchedLeaves{found});
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(traverse_pd_tree);
HWY_EXPORT(traverse_pd_tree_to_leaves);

void PdTree::collect(const Ball& ball, TriangleBuffer& candidates,
                     QueryCounts* counts) const noexcept {
  const BallScreen screen(ball, mesh().bounds(), tree_->frame());
  if (!screen.fits) {
    if (counts != nullptr) counts->triangles += mesh().triangle_count();
    return BruteForce(shared_mesh()).collect(ball, candidates);
  }
  HWY_DYNAMIC_DISPATCH(traverse_pd_tree)
  (tree_->nodes().data(), tree_->leaves().data(), mesh(), screen, candidates, counts);
}

void PdTree::Tree::collect_leaves(const Ball& ball, LeafBuffer& found) const noexcept {
  const BallScreen screen(ball, mesh().bounds(), frame_);
  if (!screen.fits) return collect_all_leaves(found);
  HWY_DYNAMIC_DISPATCH(traverse_pd_tree_to_leaves)(nodes_.data(), screen, found);
}

}  // namespace keepout

#endif  // HWY_ONCE
