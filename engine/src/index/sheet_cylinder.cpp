// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sheet_cylinder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "keepout/geometry/vec3.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "index/sheet_cylinder.cpp"
#include <hwy/foreach_target.h>
// After it, for it tells for whom to compile.
#include "../lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

// What rounding may add to a length, as a share of the sum of the coordinates' sizes: 32 u, where
// six operations and the length of the axis make less than 16 u.
constexpr float outward = 2e-6f;

HWY_INLINE Vector sum_of_lanes(Float d, const Vector& v) {
  return {hn::SumOfLanes(d, v.x), hn::SumOfLanes(d, v.y), hn::SumOfLanes(d, v.z)};
}

/// The normals of a leaf's triangles, as long as twice their areas, added up: on the side that
/// their winding tells.
HWY_INLINE Vector sum_of_normals(Float d, const LeafBlock& leaf) {
  const hn::RebindToUnsigned<Float> unsigned_lanes;
  const V zero = hn::Zero(d);
  Vector sum{zero, zero, zero};
  for (std::size_t lane = 0; lane < LeafBlock::lanes; lane += hn::Lanes(d)) {
    const Vector a = load(d, leaf.corner[0], lane);
    const Vector ab = load(d, leaf.corner[1], lane) - a;
    const Vector ac = load(d, leaf.corner[2], lane) - a;
    // The bit `odd` is where a float has its sign.
    const V sign = hn::BitCast(d, hn::And(hn::Load(unsigned_lanes, leaf.source + lane),
                                          hn::Set(unsigned_lanes, LeafBlock::odd)));
    const auto turned = [&](V p, V q, V r, V s) {
      return hn::Xor(hn::Sub(hn::Mul(p, q), hn::Mul(r, s)), sign);
    };
    sum = sum + Vector{turned(ab.y, ac.z, ab.z, ac.y), turned(ab.z, ac.x, ab.x, ac.z),
                       turned(ab.x, ac.y, ab.y, ac.x)};
  }
  return sum_of_lanes(d, sum);
}

void EncloseLeaf(const LeafBlock& leaf, CylinderBlock& cylinders, std::size_t lane) {
  const Float d;
  const V zero = hn::Zero(d);
  const V half = hn::Set(d, 0.5f);
  const Vector normals = sum_of_normals(d, leaf);
  const V length2 = dot(normals, normals);
  const M is_sheet =
      hn::And(hn::Gt(length2, hn::Set(d, 1e-30f)), hn::Lt(length2, hn::Set(d, 1e30f)));
  const V length = hn::Sqrt(hn::IfThenElse(is_sheet, length2, hn::Set(d, 1.0f)));
  const Vector axis =
      select(is_sheet, hn::Div(hn::Set(d, 1.0f), length) * normals, {zero, zero, hn::Set(d, 1.0f)});

  const auto each_corner = [&](auto&& visit) HWY_ATTR {
    for (const auto& corner : leaf.corner) {
      for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(d)) {
        visit(load(d, corner, first));
      }
    }
  };

  // The middle of the box, moved along the axis to the middle of the sheet.
  Vector low = load(d, leaf.corner[0], 0);
  Vector high = low;
  each_corner([&](const Vector& v) HWY_ATTR {
    low = least(low, v);
    high = most(high, v);
  });
  const Vector box_low{hn::MinOfLanes(d, low.x), hn::MinOfLanes(d, low.y),
                       hn::MinOfLanes(d, low.z)};
  const Vector box_high{hn::MaxOfLanes(d, high.x), hn::MaxOfLanes(d, high.y),
                        hn::MaxOfLanes(d, high.z)};
  const Vector box_middle = box_low + half * (box_high - box_low);
  V bottom = hn::Set(d, 1e30f);
  V top = hn::Set(d, -1e30f);
  each_corner([&](const Vector& v) HWY_ATTR {
    const V height = dot(axis, v - box_middle);
    bottom = hn::Min(bottom, height);
    top = hn::Max(top, height);
  });
  const V shift = hn::Mul(half, hn::Add(hn::MinOfLanes(d, bottom), hn::MaxOfLanes(d, top)));
  const Vector middle = box_middle + shift * axis;

  // Measured from where the middle has come to be.
  V half_height = zero;
  V radius2 = zero;
  V far = zero;
  each_corner([&](const Vector& v) HWY_ATTR {
    const Vector way = v - middle;
    const V height = dot(axis, way);
    const Vector across = way - height * axis;
    half_height = hn::Max(half_height, hn::Abs(height));
    radius2 = hn::Max(radius2, dot(across, across));
    far = hn::Max(far, size(way));
  });
  const float rounding = outward * hn::GetLane(hn::MaxOfLanes(d, far));
  cylinders.middle[0][lane] = hn::GetLane(middle.x);
  cylinders.middle[1][lane] = hn::GetLane(middle.y);
  cylinders.middle[2][lane] = hn::GetLane(middle.z);
  cylinders.axis[0][lane] = hn::GetLane(axis.x);
  cylinders.axis[1][lane] = hn::GetLane(axis.y);
  cylinders.axis[2][lane] = hn::GetLane(axis.z);
  cylinders.half_height[lane] = hn::GetLane(hn::MaxOfLanes(d, half_height)) + rounding;
  cylinders.radius[lane] = hn::GetLane(hn::Sqrt(hn::MaxOfLanes(d, radius2))) + rounding;
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(EncloseLeaf);

namespace {

/// One lane of a block, in double.
struct Cylinder {
  Vec3 middle;
  Vec3 axis;
  double half_height;
  double radius;
};

Vec3 vector_of(const float (&from)[3][CylinderBlock::lanes], std::size_t lane) noexcept {
  return {from[0][lane], from[1][lane], from[2][lane]};
}

Cylinder cylinder(const CylinderBlock& from, std::size_t lane) noexcept {
  return {vector_of(from.middle, lane), vector_of(from.axis, lane), from.half_height[lane],
          from.radius[lane]};
}

}  // namespace

void enclose(const LeafBlock& leaf, CylinderBlock& cylinders, std::size_t lane) noexcept {
  HWY_DYNAMIC_DISPATCH(EncloseLeaf)(leaf, cylinders, lane);
}

void enclose(const NodeBlock& node, const CylinderBlock& of_node, CylinderBlock& above,
             std::size_t lane) noexcept {
  std::size_t used = 0;
  Vec3 sum = Vec3::Zero();
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;
  for (; used < NodeBlock::lanes && node.is_used(used); ++used) {
    sum += vector_of(of_node.axis, used);
    low = low.cwiseMin(vector_of(of_node.middle, used));
    high = high.cwiseMax(vector_of(of_node.middle, used));
  }
  const Eigen::Vector3f rounded_axis =
      (sum.norm() > 0.1 ? Vec3(sum.normalized()) : vector_of(of_node.axis, 0)).cast<float>();
  const Vec3 axis = rounded_axis.cast<double>();

  const auto height_of = [&](const Cylinder& its) {
    const double along = its.axis.dot(axis);
    return its.half_height * std::abs(along) + its.radius * (its.axis - along * axis).norm();
  };
  const Vec3 box_middle = 0.5 * (low + high);
  double bottom = std::numeric_limits<double>::infinity();
  double top = -bottom;
  for (std::size_t i = 0; i < used; ++i) {
    const Cylinder its = cylinder(of_node, i);
    const double at = axis.dot(its.middle - box_middle);
    bottom = std::min(bottom, at - height_of(its));
    top = std::max(top, at + height_of(its));
  }
  const Eigen::Vector3f rounded_middle = (box_middle + 0.5 * (bottom + top) * axis).cast<float>();
  const Vec3 middle = rounded_middle.cast<double>();

  double half_height = 0.0;
  double radius = 0.0;
  double far = 0.0;
  for (std::size_t i = 0; i < used; ++i) {
    const Cylinder its = cylinder(of_node, i);
    const Vec3 way = its.middle - middle;
    const double at = axis.dot(way);
    const double along = its.axis.dot(axis);
    half_height = std::max(half_height, std::abs(at) + height_of(its));
    radius = std::max(radius, (way - at * axis).norm() + its.radius +
                                  its.half_height * (its.axis - along * axis).norm());
    far = std::max(far, way.lpNorm<1>() + its.radius + its.half_height);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    above.middle[i][lane] = rounded_middle[static_cast<Eigen::Index>(i)];
    above.axis[i][lane] = rounded_axis[static_cast<Eigen::Index>(i)];
  }
  constexpr double outward = 2e-6;  // the axes' lengths, and the rounding to float
  above.half_height[lane] = static_cast<float>(half_height + outward * far);
  above.radius[lane] = static_cast<float>(radius + outward * far);
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
