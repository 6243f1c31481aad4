// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>

#include "enclosure.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "index/wide_bvh/build/node_enclosure.cpp"
#include <hwy/foreach_target.h>
// This include must follow foreach_target.h, which sets the target to compile for.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Nodes are enclosed in double, so that rounding does not add up from level to level.

using Double = hn::CappedTag<double, NodeBlock::lanes>;
using Half = hn::Rebind<float, Double>;

struct DoubleVector {
  hn::Vec<Double> x, y, z;
};

HWY_INLINE hn::Vec<Double> promoted(const float* from) {
  return hn::PromoteTo(Double(), hn::Load(Half(), from));
}

HWY_INLINE DoubleVector promoted(const float (&from)[3][NodeBlock::lanes], std::size_t lane) {
  return {promoted(from[0] + lane), promoted(from[1] + lane), promoted(from[2] + lane)};
}

HWY_INLINE hn::Vec<Double> inner(const DoubleVector& a, const DoubleVector& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

HWY_INLINE hn::Vec<Double> norm(const DoubleVector& a) { return hn::Sqrt(inner(a, a)); }

/// Returns a - much * b.
HWY_INLINE DoubleVector less(const DoubleVector& a, hn::Vec<Double> much, const DoubleVector& b) {
  return {hn::Sub(a.x, hn::Mul(much, b.x)), hn::Sub(a.y, hn::Mul(much, b.y)),
          hn::Sub(a.z, hn::Mul(much, b.z))};
}

HWY_INLINE DoubleVector all_double(const double (&v)[3]) {
  const Double d;
  return {hn::Set(d, v[0]), hn::Set(d, v[1]), hn::Set(d, v[2])};
}

/// The extents of cylinders, measured from a point and an axis through it; one cylinder in each
/// lane. Along the axis, a cylinder extends from at - along to at + along. No point of it is
/// farther than `away` from the axis, or farther than `far` from the point.
struct Reaches {
  hn::Vec<Double> at, along, away, far;
};

HWY_INLINE Reaches reaches(const CylinderBlock& cylinders, std::size_t first,
                           const double (&from)[3], const DoubleVector& axis) {
  const auto one = hn::Set(Double(), 1.0);
  const DoubleVector way = less(promoted(cylinders.middle, first), one, all_double(from));
  const DoubleVector its_axis = promoted(cylinders.axis, first);
  const auto half_height = promoted(cylinders.half_height + first);
  const auto radius = promoted(cylinders.radius + first);
  const auto at = inner(axis, way);
  const auto cosine = inner(its_axis, axis);
  const auto sine = norm(less(its_axis, cosine, axis));
  const auto size = hn::Add(hn::Add(hn::Abs(way.x), hn::Abs(way.y)), hn::Abs(way.z));
  return {at, hn::Add(hn::Mul(half_height, hn::Abs(cosine)), hn::Mul(radius, sine)),
          hn::Add(norm(less(way, at, axis)), hn::Add(radius, hn::Mul(half_height, sine))),
          hn::Add(size, hn::Add(radius, half_height))};
}

void EncloseNode(const NodeBlock& node, const CylinderBlock& of_node, NodeBlock& boxes,
                 CylinderBlock& above, std::size_t lane) {
  const Double d;
  const auto infinite = hn::Set(d, std::numeric_limits<double>::infinity());
  std::size_t used = 1;
  while (used < NodeBlock::lanes && node.is_used(used)) ++used;
  const auto for_each_lane = [&](auto&& visit) HWY_ATTR {
    for (std::size_t first = 0; first < used; first += hn::Lanes(d)) {
      visit(first, hn::FirstN(d, used - first));
    }
  };

  double axis_sum[3];
  double box_middle[3];
  for (std::size_t i = 0; i < 3; ++i) {
    auto low = infinite, middle_low = infinite;
    auto high = hn::Neg(infinite), middle_high = high;
    auto along = hn::Zero(d);
    for_each_lane([&](std::size_t first, hn::Mask<Double> is_used) HWY_ATTR {
      const auto middle = promoted(of_node.middle[i] + first);
      const auto below = hn::Neg(infinite);
      low = hn::Min(low, promoted(node.low[i] + first));  // unused lanes have infinity
      high = hn::Max(high, hn::IfThenElse(is_used, promoted(node.high[i] + first), below));
      middle_low = hn::Min(middle_low, hn::IfThenElse(is_used, middle, infinite));
      middle_high = hn::Max(middle_high, hn::IfThenElse(is_used, middle, below));
      along = hn::Add(along, hn::IfThenElseZero(is_used, promoted(of_node.axis[i] + first)));
    });
    boxes.low[i][lane] = static_cast<float>(hn::GetLane(hn::MinOfLanes(d, low)));
    boxes.high[i][lane] = static_cast<float>(hn::GetLane(hn::MaxOfLanes(d, high)));
    box_middle[i] = 0.5 * (hn::GetLane(hn::MinOfLanes(d, middle_low)) +
                           hn::GetLane(hn::MaxOfLanes(d, middle_high)));
    axis_sum[i] = hn::GetLane(hn::SumOfLanes(d, along));
  }

  const double length =
      std::sqrt(axis_sum[0] * axis_sum[0] + axis_sum[1] * axis_sum[1] + axis_sum[2] * axis_sum[2]);
  double axis_values[3];
  for (std::size_t i = 0; i < 3; ++i) {
    above.axis[i][lane] =
        length > 0.1 ? static_cast<float>(axis_sum[i] / length) : of_node.axis[i][0];
    axis_values[i] = above.axis[i][lane];
  }
  const DoubleVector axis = all_double(axis_values);

  auto bottom = infinite;
  auto top = hn::Neg(infinite);
  for_each_lane([&](std::size_t first, hn::Mask<Double> is_used) HWY_ATTR {
    const Reaches its = reaches(of_node, first, box_middle, axis);
    bottom = hn::Min(bottom, hn::IfThenElse(is_used, hn::Sub(its.at, its.along), infinite));
    top = hn::Max(top, hn::IfThenElse(is_used, hn::Add(its.at, its.along), hn::Neg(infinite)));
  });
  const double shift =
      0.5 * (hn::GetLane(hn::MinOfLanes(d, bottom)) + hn::GetLane(hn::MaxOfLanes(d, top)));
  double middle[3];
  for (std::size_t i = 0; i < 3; ++i) {
    above.middle[i][lane] = static_cast<float>(box_middle[i] + shift * axis_values[i]);
    middle[i] = above.middle[i][lane];
  }

  auto half_height = hn::Zero(d);
  auto radius = hn::Zero(d);
  auto far = hn::Zero(d);
  for_each_lane([&](std::size_t first, hn::Mask<Double> is_used) HWY_ATTR {
    const Reaches its = reaches(of_node, first, middle, axis);
    const auto height = hn::Add(hn::Abs(its.at), its.along);
    half_height = hn::Max(half_height, hn::IfThenElseZero(is_used, height));
    radius = hn::Max(radius, hn::IfThenElseZero(is_used, its.away));
    far = hn::Max(far, hn::IfThenElseZero(is_used, its.far));
  });
  // Covers the rounding to float, and axes whose length is not exactly 1.
  constexpr double outward = 2e-6;
  const double rounding = outward * hn::GetLane(hn::MaxOfLanes(d, far));
  above.half_height[lane] =
      static_cast<float>(hn::GetLane(hn::MaxOfLanes(d, half_height)) + rounding);
  above.radius[lane] = static_cast<float>(hn::GetLane(hn::MaxOfLanes(d, radius)) + rounding);
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(EncloseNode);

void enclose(const NodeBlock& node, const CylinderBlock& of_node, NodeBlock& boxes,
             CylinderBlock& cylinders, std::size_t lane) noexcept {
  HWY_DYNAMIC_DISPATCH(EncloseNode)(node, of_node, boxes, cylinders, lane);
}

void close_lane(CylinderBlock& cylinders, std::size_t lane) noexcept {
  for (std::size_t i = 0; i < 3; ++i) {
    cylinders.middle[i][lane] = 0.0f;
    cylinders.axis[i][lane] = 0.0f;
  }
  cylinders.half_height[lane] = 0.0f;
  cylinders.radius[lane] = 0.0f;
}

}  // namespace keepout

#endif
