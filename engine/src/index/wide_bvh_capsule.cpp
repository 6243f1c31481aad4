// SPDX-License-Identifier: BSD-3-Clause
//
// What is near a capsule. A box grown by the radius and a segment are apart if one of six planes is
// between them: across the box's axes, or along one of these and the segment (Ericson, "Real-Time
// Collision Detection", 2005, 5.3.3); or if the ball around the box, which knows nothing of the
// grown box's corners, is. Rounding is a share of the coordinates, by which the box is grown as
// well.
#include <algorithm>
#include <cmath>

#include "keepout/index/wide_bvh.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "index/wide_bvh_capsule.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "leaf_test-inl.h"

#ifndef KEEPOUT_INDEX_CAPSULE_SCREEN
#define KEEPOUT_INDEX_CAPSULE_SCREEN
namespace keepout {

/// A capsule as floats see it, from the origin of a tree's frame, its numbers twice as large.
struct CapsuleScreen {
  float middle[3];    // the sum of its segment's ends
  float along[3];     // from the one to the other
  float length[3];    // the sizes of that
  float length2;      // |along|^2
  float inverse2;     // its inverse; 0 for a point
  float thickness;    // twice the radius, and what rounding may take
  bool fits = false;  // false where a float would overflow: then nothing else is to be used

  CapsuleScreen(const Capsule& capsule, const Box& bounds, const LeafFrame& frame) noexcept {
    const Vec3 from = capsule.from - frame.origin;
    const Vec3 to = capsule.to - frame.origin;
    const double size = std::max({from.lpNorm<1>(), to.lpNorm<1>(), capsule.radius,
                                  (bounds.low - frame.origin).lpNorm<1>(),
                                  (bounds.high - frame.origin).lpNorm<1>()});
    if (!(size < 1e17 && capsule.radius >= 0.0)) return;  // nor is a NaN
    fits = true;
    // Each sum and product below rounds by 2^-24 of at most four times the size: a handful of them.
    constexpr double rounding = 0x1p-17;
    thickness = static_cast<float>(2.0 * (capsule.radius + frame.error) + rounding * size);
    const double way2 = (to - from).squaredNorm();
    length2 = static_cast<float>(way2);
    inverse2 = way2 > 1e-30 ? static_cast<float>(1.0 / way2) : 0.0f;
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

/// Which of some boxes come near the capsule.
HWY_INLINE M comes_near(const Vector& low, const Vector& high, const CapsuleScreen& capsule) {
  const Float d;
  const V thickness = hn::Set(d, capsule.thickness);
  const V low_of[3] = {low.x, low.y, low.z};
  const V high_of[3] = {high.x, high.y, high.z};
  V offset[3], size[3], along[3], length[3];
  M apart = hn::Lt(thickness, hn::Zero(d));  // none
  for (int axis = 0; axis < 3; ++axis) {
    offset[axis] = hn::Sub(hn::Add(low_of[axis], high_of[axis]), hn::Set(d, capsule.middle[axis]));
    size[axis] = hn::Add(hn::Sub(high_of[axis], low_of[axis]), thickness);
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
  const Vector diagonal = high - low;
  const V reach = hn::Add(hn::Sqrt(dot(diagonal, diagonal)), thickness);
  apart = hn::Or(apart, hn::Gt(dot(towards, towards), hn::Mul(reach, reach)));
  return hn::Not(apart);
}

HWY_INLINE Vector loaded(const float (&numbers)[3][16], std::size_t first) {
  const Float d;
  return {hn::Load(d, numbers[0] + first), hn::Load(d, numbers[1] + first),
          hn::Load(d, numbers[2] + first)};
}

/// Appends the triangles of a leaf whose boxes come near.
HWY_INLINE void append_near(const LeafBlock& leaf, const CapsuleScreen& capsule,
                            TriangleBuffer& out) {
  const Float d;
  for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(d)) {
    const Vector a = loaded(leaf.corner[0], first);
    const Vector b = loaded(leaf.corner[1], first);
    const Vector c = loaded(leaf.corner[2], first);
    const Vector low{least(a.x, b.x, c.x), least(a.y, b.y, c.y), least(a.z, b.z, c.z)};
    const Vector high{most(a.x, b.x, c.x), most(a.y, b.y, c.y), most(a.z, b.z, c.z)};
    append(hn::Load(Ids(), leaf.source + first), comes_near(low, high, capsule), out);
  }
}

/// Appends the triangles in the leaves that were found.
struct NearTriangles {
  const LeafBlock* leaves;
  const CapsuleScreen& capsule;
  TriangleBuffer& out;

  HWY_INLINE void look(const std::uint32_t* found, std::size_t count) const {
    constexpr std::size_t ahead = 8;
    for (std::size_t i = 0; i < std::min(ahead, count); ++i) fetch(found[i]);
    for (std::size_t i = 0; i < count; ++i) {
      if (i + ahead < count) fetch(found[i + ahead]);
      append_near(leaves[found[i] & leaf_number], capsule, out);
    }
  }
  HWY_INLINE void fetch(std::uint32_t at) const {
    const LeafBlock& leaf = leaves[at & leaf_number];
    hwy::Prefetch(leaf.source);
    for (const auto& corner : leaf.corner) {
      for (const auto& axis : corner) hwy::Prefetch(axis);
    }
  }
};

void walk_near_capsule(const NodeBlock* nodes, const LeafBlock* leaves,
                       const CapsuleScreen& capsule, TriangleBuffer& out) {
  const Float d;
  const Ids ids;
  std::uint32_t stack[(WideBvh::most_levels + 1) * NodeBlock::lanes];
  std::size_t waiting = 0;
  LeafList list;
  const NearTriangles visitor{leaves, capsule, out};
  stack[waiting++] = 0;
  while (waiting > 0 && !out.overflowed()) {
    const NodeBlock& node = nodes[stack[--waiting]];
    const bool above_leaves = (node.child[0] & NodeBlock::leaf) != 0;
    if (above_leaves && list.room() < NodeBlock::lanes) list.show(visitor);
    std::uint32_t* to = above_leaves ? list.end() : stack + waiting;
    std::size_t count = 0;
    for (std::size_t first = 0; first < NodeBlock::lanes; first += hn::Lanes(d)) {
      const auto child = hn::Load(ids, node.child + first);
      const M near = comes_near(loaded(node.low, first), loaded(node.high, first), capsule);
      const auto used = hn::Ne(child, hn::Zero(ids));
      const LanePacking packing(hn::And(hn::RebindMask(ids, near), used));
      hn::StoreU(packing(child), ids, to + count);
      count += packing.count();
    }
    if (above_leaves) {
      list.grow(count);
    } else {
      waiting += count;
    }
  }
  list.show(visitor);
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(walk_near_capsule);

void WideBvh::collect_near(const Capsule& capsule, TriangleBuffer& candidates) const noexcept {
  const CapsuleScreen screen(capsule, mesh().bounds(), frame_);
  if (!screen.fits) return SpatialIndex::collect_near(capsule, candidates);
  HWY_DYNAMIC_DISPATCH(walk_near_capsule)(nodes_.data(), leaves_.data(), screen, candidates);
}

}  // namespace keepout

#endif  // HWY_ONCE
