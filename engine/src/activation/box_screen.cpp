// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "activation/box_screen.cpp"
#include <hwy/foreach_target.h>
// After it, for it tells for whom to compile.
#include "box_screen.h"
#include "proof_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

/// How far each cylinder reaches along a unit vector from its middle, or a little farther.
HWY_INLINE V half_extent(const Vector& axis, V half_height, V radius, const Vector& n) {
  const V along = dot(axis, n);
  const Vector across = n - along * axis;
  return hn::Add(hn::Mul(half_height, hn::Abs(along)),
                 hn::Mul(radius, hn::Sqrt(dot(across, across))));
}

/// What the direction proves that leads from each cylinder to the place of the motion that is
/// nearest to it, or nearly.
HWY_INLINE Proof proof_of_cylinder(Float d, const CylinderBlock& cylinders, std::size_t lane,
                                   const FloatTip& tip, const Vector& z, const FloatReach& reach) {
  const V zero = hn::Zero(d);
  const V one = hn::Set(d, 1.0f);
  const Vector middle = relative(d, cylinders.middle, lane, tip);
  const Vector axis = load(d, cylinders.axis, lane);
  const V half_height = hn::Load(d, cylinders.half_height + lane);
  const V radius = hn::Load(d, cylinders.radius + lane);

  const V per_length2 = hn::Div(one, hn::Max(dot(z, z), hn::Set(d, 1e-30f)));
  const auto nearest_of_motion = [&](const Vector& to) {
    return hn::Min(hn::Max(hn::Mul(dot(to, z), per_length2), zero), one) * z;
  };
  const auto nearest_of_cylinder = [&](const Vector& to) -> Vector {
    const Vector way = to - middle;
    const V along = dot(axis, way);
    const Vector across = way - along * axis;
    const V far2 = hn::Max(dot(across, across), hn::Set(d, 1e-30f));
    const V inside = hn::Min(hn::Div(radius, hn::Sqrt(far2)), one);
    const V height = hn::Max(hn::Min(along, half_height), hn::Neg(half_height));
    return middle + height * axis + inside * across;
  };
  const Vector near = nearest_of_cylinder(nearest_of_motion(middle));
  const Vector way = nearest_of_motion(near) - near;
  const V length2 = dot(way, way);
  const Vector n = hn::Div(one, hn::Sqrt(length2)) * way;
  const V support = hn::Add(dot(n, middle), half_extent(axis, half_height, radius, n));
  // Of what is in the cylinder nothing is farther from the tip.
  const V far = hn::Add(size(middle), hn::Add(half_height, radius));
  const V rounding = hn::Add(hn::Mul(far, hn::Set(d, reach.relative)), hn::Set(d, reach.slack));
  const V clear = hn::Sub(hn::Sub(hn::Neg(support), hn::Set(d, reach.margin)), rounding);
  return proof_if(d, has_direction(d, length2), n, clear);
}

/// Boxes, relative to the tip.
struct Boxes {
  Vector low, high;
};

HWY_INLINE Boxes boxes_at(Float d, const NodeBlock& node, const FloatTip& tip, std::size_t lane) {
  return {relative(d, node.low, lane, tip), relative(d, node.high, lane, tip)};
}

void EnterBoxes(const NodeBlock& node, const CylinderBlock& cylinders, const FloatTip& tip,
                const float* motion, const FloatReach& reach, BoxEntries& entries) {
  const Float d;
  const Vector z = all(d, motion);
  const V margin = hn::Set(d, reach.boxes);
  // Where the motion stands still along an axis, a box is beside it or around it for good.
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
      const V one_end = hn::Mul(hn::Sub(low, margin), per_motion);
      const V other_end = hn::Mul(hn::Add(high, margin), per_motion);
      enter = hn::Max(enter, hn::Min(one_end, other_end));
      leave = hn::Min(leave, hn::Max(one_end, other_end));
    };
    clip(boxes.low.x, boxes.high.x, inverse[0]);
    clip(boxes.low.y, boxes.high.y, inverse[1]);
    clip(boxes.low.z, boxes.high.z, inverse[2]);
    const M in_boxes = hn::Le(enter, leave);
    const Proof proof = proof_of_cylinder(d, cylinders, lane, tip, z, reach);
    const V along = dot(proof.n, z);
    const M reached = hn::AndNot(holds(d, proof, along), in_boxes);
    const V time = hn::Max(hn::Mul(enter, hn::Set(d, 0.999999f)), entry(d, proof, along));
    hn::Store(time, d, entries.time + lane);
    entries.reached |= bits(d, reached, lane);
  }
}

std::uint32_t BoxesNear(const NodeBlock& boxes, const FloatTip& center, float radius) {
  const Float d;
  const V zero = hn::Zero(d);
  std::uint32_t near = 0;
  for (std::size_t lane = 0; lane < NodeBlock::lanes; lane += hn::Lanes(d)) {
    const Boxes its = boxes_at(d, boxes, center, lane);
    const Vector nearest = most(its.low, least(its.high, {zero, zero, zero}));
    const V distance2 = dot(nearest, nearest);
    near |= bits(d, hn::Not(hn::Gt(distance2, hn::Set(d, radius * radius))), lane);
  }
  return near;
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(EnterBoxes);
HWY_EXPORT(BoxesNear);

void enter_boxes(const NodeBlock& boxes, const CylinderBlock& cylinders, const FloatTip& tip,
                 const float* motion, const FloatReach& reach, BoxEntries& entries) noexcept {
  HWY_DYNAMIC_DISPATCH(EnterBoxes)(boxes, cylinders, tip, motion, reach, entries);
}

std::uint32_t boxes_near(const NodeBlock& boxes, const FloatTip& center, float radius) noexcept {
  return HWY_DYNAMIC_DISPATCH(BoxesNear)(boxes, center, radius);
}

}  // namespace keepout

#endif
