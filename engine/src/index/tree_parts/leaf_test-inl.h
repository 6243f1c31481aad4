// SPDX-License-Identifier: BSD-3-Clause
//
// Finds the triangles of a leaf that touch a ball, sixteen at a time or as many as the processor
// can. Every lane does the same operations on every processor, so the answer and its order are the
// same. Compiled once for each SIMD target: see foreach_target.h of Highway.
#if defined(KEEPOUT_INDEX_LEAF_TEST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KEEPOUT_INDEX_LEAF_TEST_INL_H
#undef KEEPOUT_INDEX_LEAF_TEST_INL_H
#else
#define KEEPOUT_INDEX_LEAF_TEST_INL_H
#endif

#include <hwy/cache_control.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "../../lane_packing-inl.h"
#include "../../lanes-inl.h"
#include "ball_screen.h"
#include "keepout/buffer.h"
#include "keepout/geometry/closest_point.h"
#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"
#include "triangle_blocks.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

using Ids = hn::RebindToUnsigned<FloatTag>;

HWY_INLINE V min(V a, V b, V c) { return hn::Min(hn::Min(a, b), c); }
HWY_INLINE V max(V a, V b, V c) { return hn::Max(hn::Max(a, b), c); }

/// Returns the squared distances of boxes from the center of a ball, rounded down.
template <std::size_t Lanes>
HWY_INLINE V box_distance2(const float (&low)[3][Lanes], const float (&high)[3][Lanes],
                           std::size_t first, const BallScreen& ball) {
  const FloatTag d;
  V distance2 = hn::Zero(d);
  for (int axis = 0; axis < 3; ++axis) {
    const V below = hn::Sub(hn::Load(d, low[axis] + first), hn::Set(d, ball.above[axis]));
    const V above = hn::Sub(hn::Set(d, ball.below[axis]), hn::Load(d, high[axis] + first));
    const V beyond = max(below, above, hn::Zero(d));
    distance2 = hn::Add(distance2, hn::Mul(beyond, beyond));
  }
  return distance2;
}

/// Returns triangles of a leaf relative to the center of a ball.
HWY_INLINE TriangleLanes relative_to_center(const LeafBlock& leaf, std::size_t first,
                                            const BallScreen& ball) {
  const FloatTag d;
  const Vector high = all(d, ball.high_part), low = all(d, ball.low_part);
  return {load(d, leaf.corner[0], first) - high - low, load(d, leaf.corner[1], first) - high - low,
          load(d, leaf.corner[2], first) - high - low};
}

/// Returns the point of each triangle nearest to the origin. Its rounding leaves it in the
/// triangle.
HWY_INLINE Vector nearest_point(const TriangleLanes& t) {
  const FloatTag d;
  const V zero = hn::Zero(d);
  const V one = hn::Set(d, 1.0f);
  const V tiny = hn::Set(d, BallScreen::least2);
  const auto on_edge = [&](const Vector& from, const Vector& along, V forward, V length2) HWY_ATTR {
    const V share = hn::Div(forward, hn::Max(length2, tiny));
    return from + hn::Min(hn::Max(share, zero), one) * along;
  };
  const Vector ab = t.b - t.a;
  const Vector ac = t.c - t.a;
  const Vector bc = t.c - t.b;
  const V ab2 = dot(ab, ab);
  const V ac2 = dot(ac, ac);
  const V to_b = hn::Neg(dot(ab, t.a));
  const V to_c = hn::Neg(dot(ac, t.a));

  Vector best = on_edge(t.a, ab, to_b, ab2);
  V best2 = dot(best, best);
  const auto offer = [&](const Vector& other) HWY_ATTR {
    const V other2 = dot(other, other);
    best = select(hn::Lt(other2, best2), other, best);
    best2 = hn::Min(other2, best2);
  };
  offer(on_edge(t.a, ac, to_c, ac2));
  offer(on_edge(t.b, bc, hn::Neg(dot(bc, t.b)), dot(bc, bc)));

  // In the middle, both barycentric coordinates and the remainder are positive.
  const V across = dot(ab, ac);
  const V area2 = hn::Sub(hn::Mul(ab2, ac2), hn::Mul(across, across));
  const V at_b = hn::Sub(hn::Mul(ac2, to_b), hn::Mul(across, to_c));
  const V at_c = hn::Sub(hn::Mul(ab2, to_c), hn::Mul(across, to_b));
  const M inside =
      hn::And(hn::And(hn::Gt(at_b, zero), hn::Gt(at_c, zero)), hn::Lt(hn::Add(at_b, at_c), area2));
  const V scale = hn::Div(one, hn::Max(area2, tiny));
  const Vector middle = t.a + hn::Mul(at_b, scale) * ab + hn::Mul(at_c, scale) * ac;
  return select(inside, middle, best);
}

/// Returns the triangles that are surely outside the ball: beyond the plane that is perpendicular
/// to `direction`, through the corner that is nearest along it.
HWY_INLINE M surely_out(const TriangleLanes& t, const Vector& direction, V outside2_and_band) {
  const FloatTag d;
  const V along = min(dot(direction, t.a), dot(direction, t.b), dot(direction, t.c));
  const V length2 = dot(direction, direction);
  const V needed = hn::Add(hn::Mul(length2, outside2_and_band), hn::Set(d, 1e-30f));
  return hn::And(hn::And(hn::Gt(along, hn::Zero(d)), hn::Gt(hn::Mul(along, along), needed)),
                 hn::Gt(length2, hn::Set(d, 1e-25f)));
}

/// Tests the triangles from lane `first` on. Finds those that surely touch the ball, and those that
/// the exact kernel must decide.
HWY_INLINE void compare(const LeafBlock& leaf, std::size_t first, const BallScreen& ball, M& in,
                        M& in_doubt) {
  const FloatTag d;
  const TriangleLanes t = relative_to_center(leaf, first, ball);
  const V a2 = dot(t.a, t.a);
  const V b2 = dot(t.b, t.b);
  const V c2 = dot(t.c, t.c);
  const V farthest2 = max(a2, b2, c2);
  const V band = hn::Set(d, BallScreen::band);
  const V inside2 = hn::Set(d, ball.inside2);
  const V outside2 = hn::Set(d, ball.outside2);
  const V spread = hn::Mul(band, hn::Add(farthest2, outside2));
  const V beyond2 = hn::Add(outside2, spread);

  // A corner within the ball, or a plane with all corners beyond, settles most triangles.
  in = hn::Le(hn::Add(min(a2, b2, c2), spread), inside2);
  const M out = surely_out(t, t.a + t.b + t.c, beyond2);
  in_doubt = hn::Not(hn::Or(in, out));
  if (hn::AllFalse(d, in_doubt)) return;

  const Vector nearest = nearest_point(t);
  const M near = hn::Le(hn::Add(dot(nearest, nearest), spread), inside2);
  in = hn::Or(in, near);
  in_doubt = hn::AndNot(hn::Or(in, surely_out(t, nearest, beyond2)), in_doubt);
}

/// Appends the ids of a block's chosen lanes.
HWY_INLINE void append(hn::Vec<Ids> source, M chosen, TriangleBuffer& out) {
  const Ids ids;
  const auto used = hn::Ne(source, hn::Set(ids, no_triangle));
  const auto taken = hn::And(hn::RebindMask(ids, chosen), used);
  const auto triangles = hn::AndNot(hn::Set(ids, LeafBlock::odd), source);
  const LanePacking packing(taken);
  const auto packed = packing(triangles);
  const std::size_t count = packing.count();
  if (out.capacity() - out.size() >= hn::Lanes(ids)) {
    hn::StoreU(packed, ids, out.end());
    out.grow(count);
    return;
  }
  HWY_ALIGN TriangleId last[LeafBlock::lanes];
  hn::Store(packed, ids, last);
  for (std::size_t i = 0; i < count; ++i) out.push(last[i]);
}

/// Appends all triangles of a leaf.
HWY_INLINE void append_all(const LeafBlock& leaf, TriangleBuffer& out) {
  const FloatTag d;
  const Ids ids;
  const bool is_full = leaf.is_used(LeafBlock::lanes - 1);
  if (HWY_LIKELY(is_full && out.capacity() - out.size() >= LeafBlock::lanes)) {
    for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(ids)) {
      const auto source = hn::Load(ids, leaf.tagged_triangle + first);
      hn::StoreU(hn::AndNot(hn::Set(ids, LeafBlock::odd), source), ids, out.end() + first);
    }
    out.grow(LeafBlock::lanes);
    return;
  }
  const M all = hn::Eq(hn::Zero(d), hn::Zero(d));
  for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(d)) {
    append(hn::Load(ids, leaf.tagged_triangle + first), all, out);
  }
}

/// Appends the triangles of a leaf that touch the ball.
template <bool counting>
HWY_INLINE void append_touching(const LeafBlock& leaf, const BallScreen& ball, const Mesh& mesh,
                                TriangleBuffer& out, QueryCounts* counts, std::size_t& asked) {
  const FloatTag d;
  std::uint32_t doubts = 0;
  for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(d)) {
    M in, in_doubt;
    compare(leaf, first, ball, in, in_doubt);
    append(hn::Load(Ids(), leaf.tagged_triangle + first), in, out);
    if (HWY_UNLIKELY(!hn::AllFalse(d, in_doubt))) doubts |= bits(d, in_doubt, first);
  }
  if constexpr (counting) ++counts->blocks;
  for (; HWY_UNLIKELY(doubts != 0); doubts &= doubts - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(doubts));
    if (!leaf.is_used(lane)) break;
    if constexpr (counting) ++counts->triangles;
    ++asked;
    const TriangleId t = leaf.triangle(lane);
    if (closest_point(mesh.triangle(t), ball.ball.center).distance <= ball.ball.radius) {
      out.push(t);
    }
  }
}

/// A leaf in a traversal's list: its number, and a bit if all of it is in the ball.
constexpr std::uint32_t whole_leaf = std::uint32_t{1} << 30;
constexpr std::uint32_t leaf_number = whole_leaf - 1;

/// Leaves to visit. They are listed first, so that their memory is fetched before their turn.
class LeafList {
 public:
  std::uint32_t* end() { return leaves_ + size_; }
  void grow(std::size_t count) { size_ += count; }
  std::size_t room() const { return capacity - size_; }

  /// Shows the leaves to the visitor, and clears the list.
  template <class Visitor>
  HWY_INLINE void show(const Visitor& visitor) {
    visitor.look(leaves_, size_);
    size_ = 0;
  }

 private:
  static constexpr std::size_t capacity = 128;
  std::uint32_t leaves_[capacity + LeafBlock::lanes];  // stores may write beyond the end
  std::size_t size_ = 0;
};

/// Appends the triangles that touch the ball. Reports an overflow if the kernel has examined more
/// triangles than the capacity. Otherwise a ball that almost touches a whole mesh would take a time
/// that grows with the mesh.
template <bool counting>
struct TouchingTriangles {
  const LeafBlock* leaves;
  const Mesh& mesh;
  const BallScreen& ball;
  TriangleBuffer& out;
  QueryCounts* counts;

  mutable std::size_t asked = 0;  // number of triangles examined by the exact kernel

  static constexpr bool wants_whole_leaves = true;  // marked as whole

  HWY_INLINE void look(const std::uint32_t* found, std::size_t count) const {
    constexpr std::size_t ahead = 8;
    for (std::size_t i = 0; i < std::min(ahead, count); ++i) fetch(found[i]);
    for (std::size_t i = 0; i < count; ++i) {
      if (i + ahead < count) fetch(found[i + ahead]);
      const LeafBlock& leaf = leaves[found[i] & leaf_number];
      if ((found[i] & whole_leaf) != 0) {
        append_all(leaf, out);
      } else {
        append_touching<counting>(leaf, ball, mesh, out, counts, asked);
      }
    }
  }

  HWY_INLINE void fetch(std::uint32_t at) const {
    const LeafBlock& leaf = leaves[at & leaf_number];
    hwy::Prefetch(leaf.tagged_triangle);
    if ((at & whole_leaf) != 0) return;
    for (const auto& corner : leaf.corner) {
      for (const auto& axis : corner) hwy::Prefetch(axis);
    }
  }

  HWY_INLINE void count_node() const {
    if constexpr (counting) ++counts->nodes;
  }
  HWY_INLINE bool is_full() const {
    if (HWY_UNLIKELY(asked > out.capacity())) out.give_up();
    return out.overflowed();
  }
};

/// Appends the numbers of the leaves that the ball touches.
struct TouchedLeaves {
  LeafBuffer& out;

  static constexpr bool wants_whole_leaves = false;

  HWY_INLINE void look(const std::uint32_t* found, std::size_t count) const {
    for (std::size_t i = 0; i < count; ++i) out.push(found[i] & leaf_number);
  }
  HWY_INLINE void count_node() const {}
  HWY_INLINE bool is_full() const { return out.overflowed(); }
};

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // include guard, one for each target
