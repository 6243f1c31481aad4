// SPDX-License-Identifier: BSD-3-Clause
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "index/wide_bvh/traversal/box_filter.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which sets the target to compile for.
#include "filters.h"
#include "proof_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

/// Cylinders, relative to the tip.
struct Cylinders {
  Vector middle, axis;
  V half_height, radius;
};

HWY_INLINE Cylinders cylinders_at(FloatTag d, const CylinderBlock& block, const FloatTip& tip,
                                  std::size_t lane) {
  return {relative(d, block.middle, lane, tip), load(d, block.axis, lane),
          hn::Load(d, block.half_height + lane), hn::Load(d, block.radius + lane)};
}

/// Returns approximately the point of each cylinder that is nearest to p.
HWY_INLINE Vector nearest(FloatTag d, const Cylinders& c, const Vector& p) {
  const Vector way = p - c.middle;
  const V along = product(c.axis, way);
  const Vector across = sum_of(hn::Neg(along), c.axis, way);
  const V far2 = hn::Max(product(across, across), hn::Set(d, 1e-30f));
  const V inside =
      hn::Min(hn::Mul(c.radius, hn::ApproximateReciprocalSqrt(far2)), hn::Set(d, 1.0f));
  const V height = hn::Max(hn::Min(along, c.half_height), hn::Neg(c.half_height));
  return sum_of(inside, across, sum_of(height, c.axis, c.middle));
}

/// Returns the half extent of each cylinder along a unit vector, or a little more.
HWY_INLINE V half_extent(const Cylinders& c, const Vector& n) {
  const V along = product(c.axis, n);
  const Vector across = sum_of(hn::Neg(along), c.axis, n);
  return hn::MulAdd(c.half_height, hn::Abs(along),
                    hn::Mul(c.radius, hn::Sqrt(product(across, across))));
}

/// Returns the clearance that a unit vector proves.
HWY_INLINE V clear_along(FloatTag d, const Cylinders& c, const Vector& n,
                         const FloatLevels& levels) {
  const V support = hn::Add(product(n, c.middle), half_extent(c, n));
  // No point of the cylinder is farther from the tip.
  const V far = hn::Add(norm1(c.middle), hn::Add(c.half_height, c.radius));
  return clear_of(d, support, far, levels);
}

/// Boxes, relative to the tip.
struct Boxes {
  Vector low, high;
};

HWY_INLINE Boxes boxes_at(FloatTag d, const NodeBlock& node, const FloatTip& tip,
                          std::size_t lane) {
  return {relative(d, node.low, lane, tip), relative(d, node.high, lane, tip)};
}

void EnterBoxes(const NodeBlock& node, const FloatTip& tip, const float* motion,
                const FloatLevels& levels, BoxEntries& entries) {
  const FloatTag d;
  const V beyond = hn::Set(d, levels.box_level);
  // If the motion does not move along an axis, it is always within or always outside the box's
  // extent along that axis.
  V inverse[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    constexpr float least_motion = 1e-30f;
    const float along = motion[axis];
    const bool stands = along < least_motion && along > -least_motion;
    inverse[axis] = hn::Set(d, stands ? 1.0f / least_motion : 1.0f / along);
  }
  entries.reached = 0;
  for (std::size_t lane = 0; lane < NodeBlock::lanes; lane += hn::Lanes(d)) {
    const Boxes boxes = boxes_at(d, node, tip, lane);
    V enter = hn::Zero(d);
    V leave = hn::Set(d, 1.0f);
    const auto clip = [&](V low, V high, V per_motion) {
      const V one_end = hn::Mul(hn::Sub(low, beyond), per_motion);
      const V other_end = hn::Mul(hn::Add(high, beyond), per_motion);
      enter = hn::Max(enter, hn::Min(one_end, other_end));
      leave = hn::Min(leave, hn::Max(one_end, other_end));
    };
    clip(boxes.low.x, boxes.high.x, inverse[0]);
    clip(boxes.low.y, boxes.high.y, inverse[1]);
    clip(boxes.low.z, boxes.high.z, inverse[2]);
    hn::Store(hn::Mul(enter, hn::Set(d, never_late)), d, entries.time + lane);
    entries.reached |= bits(d, hn::Le(enter, leave), lane);
  }
}

void EnterCylinders(const CylinderBlock& block, const FloatTip& tip, const float* motion,
                    const FloatLevels& levels, BoxEntries& entries) {
  const FloatTag d;
  const Vector z = all(d, motion);
  const V per_length2 = hn::Div(hn::Set(d, 1.0f), hn::Max(product(z, z), hn::Set(d, 1e-30f)));
  const auto nearest_of_motion = [&](const Vector& to) {
    const V along = hn::Mul(product(to, z), per_length2);
    return hn::Min(hn::Max(along, hn::Zero(d)), hn::Set(d, 1.0f)) * z;
  };
  std::uint32_t clear = 0;
  for (std::size_t lane = 0; lane < CylinderBlock::lanes; lane += hn::Lanes(d)) {
    const M asked = lanes_of(d, entries.reached, lane);
    if (hn::AllFalse(d, asked)) continue;
    const Cylinders its = cylinders_at(d, block, tip, lane);
    // The direction to about the point where the motion is nearest to the cylinder.
    const Vector near = nearest(d, its, nearest_of_motion(its.middle));
    const Proof proof = proof_along(d, its, nearest_of_motion(near) - near, levels);
    const V along = product(proof.n, z);
    V time = hn::Max(hn::Load(d, entries.time + lane), entry(d, proof, along));
    M is_clear = holds(d, proof, along);
    // A Newton step from the time so far, up to which the motion is clear.
    if (!hn::AllTrue(d, hn::Or(is_clear, hn::Not(asked)))) {
      const V at = hn::Min(time, hn::Set(d, 1.0f));
      const Vector there = at * z;
      const Proof later = proof_along(d, its, there - nearest(d, its, there), levels);
      const V along_later = product(later.n, z);
      is_clear = hn::Or(is_clear, stays(d, later, along_later, at));
      time = hn::Max(time, entry(d, later, along_later));
      is_clear = hn::Or(is_clear, hn::Gt(time, hn::Set(d, 1.0f)));
    }
    hn::Store(time, d, entries.time + lane);
    clear |= bits(d, is_clear, lane);
  }
  entries.reached &= ~clear;
}

/// Returns the squared distances of the boxes from the point that they are relative to.
HWY_INLINE V distance2(FloatTag d, const Boxes& boxes) {
  const V zero = hn::Zero(d);
  const Vector nearest = max(boxes.low, min(boxes.high, {zero, zero, zero}));
  return dot(nearest, nearest);
}

std::uint32_t BoxesNear(const NodeBlock& boxes, const FloatTip& center, float radius) {
  const FloatTag d;
  std::uint32_t near = 0;
  for (std::size_t lane = 0; lane < NodeBlock::lanes; lane += hn::Lanes(d)) {
    const V its = distance2(d, boxes_at(d, boxes, center, lane));
    near |= bits(d, hn::Not(hn::Gt(its, hn::Set(d, radius * radius))), lane);
  }
  return near;
}

float DistanceToBoxes(const NodeBlock& boxes, const FloatTip& center) {
  const FloatTag d;
  V least2 = hn::Set(d, std::numeric_limits<float>::infinity());
  for (std::size_t lane = 0; lane < NodeBlock::lanes; lane += hn::Lanes(d)) {
    least2 = hn::Min(least2, distance2(d, boxes_at(d, boxes, center, lane)));
  }
  constexpr float down = 1.0f - 4e-6f;
  return down * hn::GetLane(hn::Sqrt(hn::MinOfLanes(d, least2)));
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(EnterBoxes);
HWY_EXPORT(EnterCylinders);
HWY_EXPORT(BoxesNear);
HWY_EXPORT(DistanceToBoxes);

void enter_boxes(const NodeBlock& boxes, const FloatTip& tip, const float* motion,
                 const FloatLevels& levels, BoxEntries& entries) noexcept {
  HWY_DYNAMIC_DISPATCH(EnterBoxes)(boxes, tip, motion, levels, entries);
}

void enter_cylinders(const CylinderBlock& cylinders, const FloatTip& tip, const float* motion,
                     const FloatLevels& levels, BoxEntries& entries) noexcept {
  HWY_DYNAMIC_DISPATCH(EnterCylinders)(cylinders, tip, motion, levels, entries);
}

std::uint32_t boxes_near(const NodeBlock& boxes, const FloatTip& center, float radius) noexcept {
  return HWY_DYNAMIC_DISPATCH(BoxesNear)(boxes, center, radius);
}

float distance_to_boxes(const NodeBlock& boxes, const FloatTip& center) noexcept {
  return HWY_DYNAMIC_DISPATCH(DistanceToBoxes)(boxes, center);
}

}  // namespace keepout

#endif
