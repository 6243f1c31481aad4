// SPDX-License-Identifier: BSD-3-Clause
//
// Finds the triangles near a capsule. A box grown by the radius and a segment are apart if one of
// six planes is between them. The planes are across the box's axes, or along one of these and the
// segment. Source: Ericson, "Real-Time Collision Detection", 2005, 5.3.3. They are also apart if
// the segment is farther than the radius from the ball around the box. This test excludes the
// corners of the grown box, which reach too far. Rounding is proportional to the coordinates, and
// the box is also grown by it.
#include <algorithm>
#include <bit>
#include <cmath>

#include "../tree.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "index/wide_bvh/query/capsule.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "../../tree_parts/leaf_test-inl.h"

#ifndef KEEPOUT_INDEX_CAPSULE_SCREEN
#define KEEPOUT_INDEX_CAPSULE_SCREEN
namespace keepout {

/// A capsule in floats, relative to the origin of a tree's frame, with all lengths doubled.
struct CapsuleScreen {
  float middle[3];    // the sum of the segment's ends
  float along[3];     // from one end to the other
  float length[3];    // absolute values of along
  float length2;      // |along|^2
  float inverse2;     // 1 / |along|^2; 0 for a point
  float thickness;    // twice the radius, plus rounding
  bool fits = false;  // false if a float would overflow; then the other members are invalid

  CapsuleScreen(const Capsule& capsule, const Box& bounds, const LeafFrame& frame) noexcept {
    const Vec3 from = capsule.from - frame.origin;
    const Vec3 to = capsule.to - frame.origin;
    const double size = std::max({from.lpNorm<1>(), to.lpNorm<1>(), capsule.radius,
                                  (bounds.low - frame.origin).lpNorm<1>(),
                                  (bounds.high - frame.origin).lpNorm<1>()});
    // Below 1e-12 the inverse of a square may overflow. Rejects NaN as well.
    if (!(size > 1e-12 && size < 1e17 && capsule.radius >= 0.0)) return;
    fits = true;
    // Each sum and product below, a handful, rounds by 2^-24 of at most four times the size.
    constexpr double rounding = 0x1p-17;
    thickness = static_cast<float>(2.0 * (capsule.radius + frame.error) + rounding * size);
    const double way2 = (to - from).squaredNorm();
    length2 = static_cast<float>(way2);
    // A segment shorter than the rounding counts as a point: the rounding in the thickness covers
    // the distance to its middle.
    const bool is_point = way2 <= rounding * rounding * size * size / 64.0;
    inverse2 = is_point ? 0.0f : static_cast<float>(1.0 / way2);
    for (int axis = 0; axis < 3; ++axis) {
      middle[axis] = static_cast<float>(from[axis] + to[axis]);
      along[axis] = static_cast<float>(to[axis] - from[axis]);
      length[axis] = std::abs(along[axis]);
    }
  }
};

}  // namespace keepout
#endif

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

/// Returns the boxes of sixteen that come near the capsule, one bit each.
HWY_NOINLINE std::uint32_t boxes_nearby(const float (&low)[3][NodeBlock::lanes],
                                        const float (&high)[3][NodeBlock::lanes],
                                        const CapsuleScreen& capsule) {
  const FloatTag d;
  const V thickness = hn::Set(d, capsule.thickness);
  std::uint32_t nearby = 0;
  for (std::size_t first = 0; first < NodeBlock::lanes; first += hn::Lanes(d)) {
    V offset[3], size[3], along[3], length[3];
    M apart = hn::Lt(thickness, hn::Zero(d));  // none
    V diagonal2 = hn::Zero(d);
    for (int axis = 0; axis < 3; ++axis) {
      const V least = hn::Load(d, low[axis] + first);
      const V most = hn::Load(d, high[axis] + first);
      const V width = hn::Sub(most, least);
      diagonal2 = hn::Add(diagonal2, hn::Mul(width, width));
      offset[axis] = hn::Sub(hn::Add(least, most), hn::Set(d, capsule.middle[axis]));
      size[axis] = hn::Add(width, thickness);
      along[axis] = hn::Set(d, capsule.along[axis]);
      length[axis] = hn::Set(d, capsule.length[axis]);
      apart = hn::Or(apart, hn::Gt(hn::Abs(offset[axis]), hn::Add(size[axis], length[axis])));
    }
    for (int axis = 0; axis < 3; ++axis) {
      const int j = (axis + 1) % 3;
      const int k = (axis + 2) % 3;
      const V across = hn::Sub(hn::Mul(offset[j], along[k]), hn::Mul(offset[k], along[j]));
      const V reach = hn::Add(hn::Mul(size[j], length[k]), hn::Mul(size[k], length[j]));
      apart = hn::Or(apart, hn::Gt(hn::Abs(across), reach));
    }
    const Vector from_middle{offset[0], offset[1], offset[2]};
    const Vector way{along[0], along[1], along[2]};
    const V ahead = hn::Set(d, capsule.length2);
    const V behind = hn::Sub(hn::Zero(d), ahead);
    const V nearest = hn::Min(hn::Max(dot(from_middle, way), behind), ahead);
    const Vector towards = from_middle - hn::Mul(nearest, hn::Set(d, capsule.inverse2)) * way;
    const V reach = hn::Add(hn::Sqrt(diagonal2), thickness);
    apart = hn::Or(apart, hn::Gt(dot(towards, towards), hn::Mul(reach, reach)));
    nearby |= bits(d, hn::Not(apart), first);
  }
  return nearby;
}

/// Appends the triangles of a leaf whose boxes come near the capsule.
HWY_INLINE void append_near(const LeafBlock& leaf, const CapsuleScreen& capsule,
                            TriangleBuffer& out) {
  const FloatTag d;
  alignas(64) float low[3][LeafBlock::lanes];
  alignas(64) float high[3][LeafBlock::lanes];
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(d)) {
      const V a = hn::Load(d, leaf.corner[0][axis] + first);
      const V b = hn::Load(d, leaf.corner[1][axis] + first);
      const V c = hn::Load(d, leaf.corner[2][axis] + first);
      hn::Store(min(a, b, c), d, low[axis] + first);
      hn::Store(max(a, b, c), d, high[axis] + first);
    }
  }
  for (std::uint32_t nearby = boxes_nearby(low, high, capsule); nearby != 0; nearby &= nearby - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(nearby));
    if (!leaf.is_used(lane)) break;
    out.push(leaf.triangle(lane));
  }
}

HWY_INLINE void fetch(const LeafBlock& leaf) {
  hwy::Prefetch(leaf.tagged_triangle);
  for (const auto& corner : leaf.corner) {
    for (const auto& axis : corner) hwy::Prefetch(axis);
  }
}

void traverse_near_capsule(const NodeBlock* nodes, const LeafBlock* leaves,
                           const CapsuleScreen& capsule, TriangleBuffer& out) {
  std::uint32_t stack[(WideBvh::most_levels + 1) * NodeBlock::lanes];
  std::size_t waiting = 0;
  stack[waiting++] = 0;
  while (waiting > 0 && !out.overflowed()) {
    const NodeBlock& node = nodes[stack[--waiting]];
    std::uint32_t found[NodeBlock::lanes];
    std::size_t count = 0;
    for (std::uint32_t nearby = boxes_nearby(node.low, node.high, capsule); nearby != 0;
         nearby &= nearby - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(nearby));
      if (!node.is_used(lane)) break;
      const std::uint32_t child = node.child[lane];
      if ((child & NodeBlock::leaf_bit) == 0) {
        stack[waiting++] = child;
      } else {
        found[count++] = child & ~NodeBlock::leaf_bit;
        fetch(leaves[found[count - 1]]);
      }
    }
    for (std::size_t i = 0; i < count; ++i) append_near(leaves[found[i]], capsule, out);
  }
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(traverse_near_capsule);

void WideBvh::collect_near(const Capsule& capsule, TriangleBuffer& candidates) const noexcept {
  const CapsuleScreen screen(capsule, mesh().bounds(), tree_->frame());
  if (!screen.fits) return SpatialIndex::collect_near(capsule, candidates);
  HWY_DYNAMIC_DISPATCH(traverse_near_capsule)
  (tree_->nodes().data(), tree_->leaves().data(), screen, candidates);
}

}  // namespace keepout

#endif  // HWY_ONCE
