// SPDX-License-Identifier: BSD-3-Clause
//
// The nearest triangle by branch and bound: the nearest boxes first, and none that is farther away
// than a triangle that was found. Floats tell what is surely farther, as in a query with a ball
// that reaches as far as the best so far (ball_screen.cpp has the bounds); the exact kernel decides
// about the rest, ties included. So the answer is that of asking it about all triangles.
#include <array>
#include <limits>

#include "../../tree_parts/prefetch.h"
#include "../tree.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "index/wide_bvh/query/nearest.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "../../tree_parts/leaf_test-inl.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

/// The best so far, and who is no nearer for sure.
struct Best {
  TriangleId triangle;
  BallScreen reach;  // of the ball that it touches
};

/// The squared distances of a node's boxes from the centre, rounded down.
HWY_INLINE void measure_boxes(const NodeBlock& node, const BallScreen& ball, float* distance2) {
  const Float d;
  for (std::size_t first = 0; first < NodeBlock::lanes; first += hn::Lanes(d)) {
    V near2 = hn::Zero(d);
    for (int axis = 0; axis < 3; ++axis) {
      const V low = hn::Load(d, node.low[axis] + first);
      const V high = hn::Load(d, node.high[axis] + first);
      const V beyond = most(hn::Sub(low, hn::Set(d, ball.above[axis])),
                            hn::Sub(hn::Set(d, ball.below[axis]), high), hn::Zero(d));
      near2 = hn::Add(near2, hn::Mul(beyond, beyond));
    }
    hn::Store(near2, d, distance2 + first);
  }
}

/// What of a leaf is not surely farther than the best: a bit for each triangle. `likely` is the one
/// whose nearest point floats find nearest.
HWY_INLINE std::uint32_t no_farther(const LeafBlock& leaf, const BallScreen& ball,
                                    std::size_t& likely) {
  const Float d;
  const V band = hn::Set(d, BallScreen::band);
  const V outside2 = hn::Set(d, ball.outside2);
  std::uint32_t left = 0;
  HWY_ALIGN float distance2[LeafBlock::lanes];
  for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(d)) {
    const Corners3 t{relative_to_center(leaf.corner[0], first, ball),
                     relative_to_center(leaf.corner[1], first, ball),
                     relative_to_center(leaf.corner[2], first, ball)};
    const V farthest2 = most(dot(t.a, t.a), dot(t.b, t.b), dot(t.c, t.c));
    const V beyond2 = hn::Add(outside2, hn::Mul(band, hn::Add(farthest2, outside2)));
    M out = surely_out(t, t.a + t.b + t.c, beyond2);
    if (hn::AllTrue(d, out)) continue;
    const Vector nearest = nearest_point(t);
    out = hn::Or(out, surely_out(t, nearest, beyond2));
    hn::Store(dot(nearest, nearest), d, distance2 + first);
    left |= bits(d, hn::Not(out), first);
  }
  float least2 = std::numeric_limits<float>::infinity();
  for (std::uint32_t lanes = left; lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
    if (!(distance2[lane] < least2)) continue;
    least2 = distance2[lane];
    likely = lane;
  }
  return left;
}

/// Asks the exact kernel about a triangle. Its corners are at hand, in the order that the kernel
/// puts them in, where the mesh's coordinates are floats.
HWY_INLINE void ask(const LeafBlock& leaf, std::size_t lane, const WideBvh::Tree& tree,
                    Best& best) {
  if (!leaf.is_used(lane)) return;
  const TriangleId t = leaf.triangle(lane);
  const Ball& ball = best.reach.ball;
  const auto corner = [&](std::size_t c) -> Vec3 {
    return {leaf.corner[c][0][lane], leaf.corner[c][1][lane], leaf.corner[c][2][lane]};
  };
  const double distance =
      tree.frame().is_exact()
          ? closest_point_of_ordered({corner(0), corner(1), corner(2)}, ball.center).distance
          : closest_point(tree.mesh().triangle(t), ball.center).distance;
  if (distance > ball.radius) return;
  if (distance == ball.radius) {
    best.triangle = std::min(best.triangle, t);
    return;
  }
  best = {t, BallScreen({ball.center, distance}, tree.mesh().bounds(), tree.frame())};
}

// In looks: mostly a wait for what nothing has brought nearer.
constexpr std::size_t work_of_looking = 3;
constexpr std::size_t work_of_asking = 3;

/// Looks at a leaf: first at its likely nearest, which leaves few others to ask about.
HWY_INLINE void look(const LeafBlock& leaf, const WideBvh::Tree& tree, Budget& budget, Best& best) {
  std::size_t likely = 0;
  std::uint32_t left = no_farther(leaf, best.reach, likely);
  if (left == 0) return;
  const double before = best.reach.ball.radius;
  budget.spend(work_of_asking);
  ask(leaf, likely, tree, best);
  const std::uint32_t asked = std::uint32_t{1} << likely;
  if (best.reach.ball.radius < before) left = no_farther(leaf, best.reach, likely);
  for (left &= ~asked; left != 0; left &= left - 1) {
    budget.spend(work_of_asking);
    ask(leaf, static_cast<std::size_t>(std::countr_zero(left)), tree, best);
  }
}

/// Prefetches a leaf or a node.
HWY_INLINE void fetch(const WideBvh::Tree& tree, std::uint32_t what) {
  if ((what & NodeBlock::leaf) != 0) {
    prefetch(tree.leaves()[what & ~NodeBlock::leaf]);
  } else {
    prefetch(tree.nodes()[what]);
  }
}

/// Looks into boxes, the nearest first, but not into what `is_beyond`. `measure` tells how far the
/// boxes of a node are at least, and `look` looks at a leaf. Whether the budget was enough.
template <class Distance, class IsBeyond, class Measure, class Look>
HWY_INLINE bool walk(const WideBvh::Tree& tree, Budget& budget, const IsBeyond& is_beyond,
                     const Measure& measure, const Look& look) {
  struct Waiting {
    Distance distance;
    std::uint32_t what;  // as NodeBlock::child
  };
  // The boxes of each level but the one that was opened, and those of the last.
  std::array<Waiting, WideBvh::most_levels * NodeBlock::lanes> stack;
  std::size_t waiting = 0;
  stack[waiting++] = {0, 0};
  while (waiting > 0) {
    const Waiting next = stack[--waiting];
    if (is_beyond(next.distance)) continue;
    budget.spend(work_of_looking);
    if (budget.is_spent()) return false;
    if ((next.what & NodeBlock::leaf) != 0) {
      look(tree.leaves()[next.what & ~NodeBlock::leaf]);
      continue;
    }
    const NodeBlock& node = tree.nodes()[next.what];
    HWY_ALIGN Distance distance[NodeBlock::lanes];
    measure(node, distance);
    // The nearest on top.
    const std::size_t bottom = waiting;
    for (std::size_t lane = 0; lane < NodeBlock::lanes && node.is_used(lane); ++lane) {
      if (is_beyond(distance[lane])) continue;
      std::size_t at = waiting++;
      for (; at > bottom && stack[at - 1].distance < distance[lane]; --at) {
        stack[at] = stack[at - 1];
      }
      stack[at] = {distance[lane], node.child[lane]};
    }
    constexpr std::size_t ahead = 3;
    for (std::size_t i = waiting; i > bottom && i + ahead >= waiting + 1; --i) {
      fetch(tree, stack[i - 1].what);
    }
  }
  return true;
}

TriangleId nearest_in_floats(const WideBvh::Tree& tree, const BallScreen& around_all,
                             Budget& budget) {
  Best best{no_triangle, around_all};
  const bool is_found = walk<float>(
      tree, budget, [&](float distance2) HWY_ATTR { return distance2 > best.reach.box_reach2; },
      [&](const NodeBlock& node, float* distance2)
          HWY_ATTR { measure_boxes(node, best.reach, distance2); },
      [&](const LeafBlock& leaf) HWY_ATTR { look(leaf, tree, budget, best); });
  return is_found ? best.triangle : no_triangle;
}

/// The same for a point so far off that floats cannot tell one box from the next: in double, a box
/// and a triangle at a time.
TriangleId nearest_from_afar(const WideBvh::Tree& tree, const Vec3& point, Budget& budget) {
  TriangleId best = no_triangle;
  double least = std::numeric_limits<double>::infinity();
  const Vec3 from_origin = point - tree.frame().origin;
  const auto measure = [&](const NodeBlock& node, double* distance) {
    for (std::size_t lane = 0; lane < NodeBlock::lanes && node.is_used(lane); ++lane) {
      const Vec3 low(node.low[0][lane], node.low[1][lane], node.low[2][lane]);
      const Vec3 high(node.high[0][lane], node.high[1][lane], node.high[2][lane]);
      // Less by far more than what the kernel and this lose to rounding.
      distance[lane] =
          distance_to({low, high}, from_origin) * (1.0 - 1e-12) - 2.0 * tree.frame().error;
    }
  };
  const auto look = [&](const LeafBlock& leaf) {
    budget.spend(LeafBlock::lanes);
    for (std::size_t lane = 0; lane < LeafBlock::lanes && leaf.is_used(lane); ++lane) {
      const TriangleId t = leaf.triangle(lane);
      const double distance = closest_point(tree.mesh().triangle(t), point).distance;
      if (distance > least || (distance == least && best < t)) continue;
      best = t;
      least = distance;
    }
  };
  const bool is_found = walk<double>(
      tree, budget, [&](double distance) { return distance > least; }, measure, look);
  return is_found ? best : no_triangle;
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(nearest_in_floats);
HWY_EXPORT(nearest_from_afar);

TriangleId WideBvh::nearest(const Vec3& point, Budget& budget) const noexcept {
  // No triangle is farther away than the far corner of the box around them.
  const Box& bounds = mesh().bounds();
  const double farthest =
      (point - bounds.low).cwiseAbs().cwiseMax((bounds.high - point).cwiseAbs()).norm();
  const BallScreen around_all({point, farthest * (1.0 + 1e-12)}, bounds, tree_->frame());
  constexpr double afar = 32.0;  // times the mesh: from there on it is the faster one
  if (!around_all.fits || farthest > afar * bounds.size().norm()) {
    return HWY_DYNAMIC_DISPATCH(nearest_from_afar)(*tree_, point, budget);
  }
  return HWY_DYNAMIC_DISPATCH(nearest_in_floats)(*tree_, around_all, budget);
}

}  // namespace keepout

#endif  // HWY_ONCE
