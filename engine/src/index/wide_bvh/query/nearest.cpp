// SPDX-License-Identifier: BSD-3-Clause
//
// Finds the nearest triangle by branch and bound: the nearest boxes first, and no box that is
// farther away than a triangle already found. Single precision excludes triangles that are surely
// farther, as in a query with a ball up to the nearest triangle so far (bounds: ball_screen.cpp).
// The exact kernel decides about the others, including ties. So the answer is that of the kernel on
// all triangles.
#include <array>
#include <limits>

#include "../tree.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "index/wide_bvh/query/nearest.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "../../tree_parts/leaf_test-inl.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

/// The nearest triangle so far, and the ball up to it, which excludes triangles that are surely
/// farther.
struct Best {
  TriangleId triangle;
  BallScreen screen;  // of the ball whose surface the triangle touches
};

/// Fills `distance2` with the squared distances of a node's boxes from the center, rounded down.
HWY_INLINE void measure_boxes(const NodeBlock& node, const BallScreen& ball, float* distance2) {
  const FloatTag d;
  for (std::size_t first = 0; first < NodeBlock::lanes; first += hn::Lanes(d)) {
    hn::Store(box_distance2(node.low, node.high, first, ball), d, distance2 + first);
  }
}

/// Returns the triangles of a leaf that are not surely farther than the best, one bit each.
/// `likely`: the one that is nearest in single precision.
HWY_INLINE std::uint32_t no_farther(const LeafBlock& leaf, const BallScreen& ball,
                                    std::size_t& likely) {
  const FloatTag d;
  const V band = hn::Set(d, BallScreen::band);
  const V outside2 = hn::Set(d, ball.outside2);
  std::uint32_t left = 0;
  HWY_ALIGN float distance2[LeafBlock::lanes];
  for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(d)) {
    const TriangleLanes t = relative_to_center(leaf, first, ball);
    const V farthest2 = max(dot(t.a, t.a), dot(t.b, t.b), dot(t.c, t.c));
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

/// Compares a triangle with the best one by the exact kernel. If the tree has the mesh's own
/// coordinates, the leaf has the corners in the order that the kernel needs.
HWY_INLINE void decide(const LeafBlock& leaf, std::size_t lane, const WideBvh::Tree& tree,
                       Best& best) {
  if (!leaf.is_used(lane)) return;
  const TriangleId t = leaf.triangle(lane);
  const Ball& ball = best.screen.ball;
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

/// Compares the triangles of a leaf with the best one. The likely nearest comes first, so that few
/// others need a decision.
HWY_INLINE void search_leaf(const LeafBlock& leaf, const WideBvh::Tree& tree, Budget& budget,
                            Best& best) {
  std::size_t likely = 0;
  std::uint32_t left = no_farther(leaf, best.screen, likely);
  if (left == 0) return;
  const double before = best.screen.ball.radius;
  budget.spend(work::nearest_decision);
  decide(leaf, likely, tree, best);
  const std::uint32_t asked = std::uint32_t{1} << likely;
  if (best.screen.ball.radius < before) left = no_farther(leaf, best.screen, likely);
  for (left &= ~asked; left != 0; left &= left - 1) {
    budget.spend(work::nearest_decision);
    decide(leaf, static_cast<std::size_t>(std::countr_zero(left)), tree, best);
  }
}

/// Prefetches a leaf or a node.
HWY_INLINE void prefetch_child(const WideBvh::Tree& tree, std::uint32_t what) {
  if ((what & NodeBlock::leaf_bit) != 0) {
    prefetch(tree.leaves()[what & ~NodeBlock::leaf_bit]);
  } else {
    prefetch(tree.nodes()[what]);
  }
}

/// Opens boxes, the nearest first, except those that `is_beyond`. `measure` computes lower bounds
/// of the distances of a node's boxes. Returns false if the budget ended first.
template <class Distance, class IsBeyond, class Measure, class SearchLeaf>
HWY_INLINE bool search_boxes(const WideBvh::Tree& tree, Budget& budget, const IsBeyond& is_beyond,
                             const Measure& measure, const SearchLeaf& search_leaf) {
  struct Waiting {
    Distance distance;
    std::uint32_t what;  // as NodeBlock::child
  };
  // The boxes of each level except the opened one, and all those of the last level.
  std::array<Waiting, WideBvh::most_levels * NodeBlock::lanes> stack;
  std::size_t waiting = 0;
  stack[waiting++] = {0, 0};
  while (waiting > 0) {
    const Waiting next = stack[--waiting];
    if (is_beyond(next.distance)) continue;
    budget.spend(work::nearest_box);
    if (budget.is_spent()) return false;
    if ((next.what & NodeBlock::leaf_bit) != 0) {
      search_leaf(tree.leaves()[next.what & ~NodeBlock::leaf_bit]);
      continue;
    }
    const NodeBlock& node = tree.nodes()[next.what];
    HWY_ALIGN Distance distance[NodeBlock::lanes];
    measure(node, distance);
    // Insert so that the nearest is on top.
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
      prefetch_child(tree, stack[i - 1].what);
    }
  }
  return true;
}

TriangleId nearest_in_floats(const WideBvh::Tree& tree, const BallScreen& around_all,
                             Budget& budget) {
  Best best{no_triangle, around_all};
  const bool is_found = search_boxes<float>(
      tree, budget, [&](float distance2) HWY_ATTR { return distance2 > best.screen.box_reach2; },
      [&](const NodeBlock& node, float* distance2)
          HWY_ATTR { measure_boxes(node, best.screen, distance2); },
      [&](const LeafBlock& leaf) HWY_ATTR { search_leaf(leaf, tree, budget, best); });
  return is_found ? best.triangle : no_triangle;
}

/// Like nearest_in_floats(), for a point so far away that floats cannot distinguish boxes. Works in
/// double, on one box or triangle at a time.
TriangleId nearest_from_afar(const WideBvh::Tree& tree, const Vec3& point, Budget& budget) {
  TriangleId best = no_triangle;
  double least = std::numeric_limits<double>::infinity();
  const Vec3 from_origin = point - tree.frame().origin;
  const auto measure = [&](const NodeBlock& node, double* distance) {
    for (std::size_t lane = 0; lane < NodeBlock::lanes && node.is_used(lane); ++lane) {
      const Vec3 low(node.low[0][lane], node.low[1][lane], node.low[2][lane]);
      const Vec3 high(node.high[0][lane], node.high[1][lane], node.high[2][lane]);
      // Reduced by far more than the rounding of the kernel and of this sum.
      distance[lane] =
          distance_to({low, high}, from_origin) * (1.0 - 1e-12) - 2.0 * tree.frame().error;
    }
  };
  const auto search_leaf = [&](const LeafBlock& leaf) {
    budget.spend(LeafBlock::lanes * work::nearest_decision);
    for (std::size_t lane = 0; lane < LeafBlock::lanes && leaf.is_used(lane); ++lane) {
      const TriangleId t = leaf.triangle(lane);
      const double distance = closest_point(tree.mesh().triangle(t), point).distance;
      if (distance > least || (distance == least && best < t)) continue;
      best = t;
      least = distance;
    }
  };
  const bool is_found = search_boxes<double>(
      tree, budget, [&](double distance) { return distance > least; }, measure, search_leaf);
  return is_found ? best : no_triangle;
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(nearest_in_floats);
HWY_EXPORT(nearest_from_afar);

TriangleId WideBvh::nearest(const Vec3& point, Budget& budget) const noexcept {
  // No triangle is farther away than the farthest corner of the bounds.
  const Box& bounds = mesh().bounds();
  const double farthest =
      (point - bounds.low).cwiseAbs().cwiseMax((bounds.high - point).cwiseAbs()).norm();
  const BallScreen around_all({point, farthest * (1.0 + 1e-12)}, bounds, tree_->frame());
  constexpr double afar = 32.0;  // diagonals of the mesh: beyond, nearest_from_afar is faster
  if (!around_all.fits || farthest > afar * bounds.size().norm()) {
    return HWY_DYNAMIC_DISPATCH(nearest_from_afar)(*tree_, point, budget);
  }
  return HWY_DYNAMIC_DISPATCH(nearest_in_floats)(*tree_, around_all, budget);
}

}  // namespace keepout

#endif  // HWY_ONCE
