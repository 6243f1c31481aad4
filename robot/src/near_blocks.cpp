// SPDX-License-Identifier: BSD-3-Clause
//
// The error bound of the screen. Let u = 2^-24 be the unit roundoff of a float and S the largest
// coordinate. Let v be the corners of a triangle, e the ends of a segment, and t any vector. Then
// their distance is at least q = (min t . v - max t . e) / |t|. In single precision, coordinates
// are off by u S each, and the products and sums of t . v by less than 4 u S |t|. So q is off by
// less than 16 u S for any t. NearScreen enlarges the distance by four times that.
#include "near_blocks.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "near_blocks.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Float = hn::CappedTag<float, NearBlock::lanes>;
using V = hn::Vec<Float>;

HWY_INLINE V dot(const V (&a)[3], const V (&b)[3]) {
  return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
}

std::uint32_t lanes_that_may_be_near(const NearBlock& block, const NearScreen& screen) {
  const Float d;
  std::uint32_t bits = 0;
  for (std::size_t first = 0; first < NearBlock::lanes; first += hn::Lanes(d)) {
    V corner[3][3], from[3], along[3], to_middle[3], towards[3];
    for (int axis = 0; axis < 3; ++axis) {
      for (int c = 0; c < 3; ++c) corner[c][axis] = hn::Load(d, block.corner[c][axis] + first);
      from[axis] = hn::Set(d, screen.from[axis]);
      along[axis] = hn::Set(d, screen.along[axis]);
      const V sum = hn::Add(hn::Add(corner[0][axis], corner[1][axis]), corner[2][axis]);
      to_middle[axis] = hn::Sub(hn::Mul(sum, hn::Set(d, 1.0f / 3.0f)), from[axis]);
    }
    const V fraction = hn::Mul(dot(to_middle, along), hn::Set(d, screen.inverse2));
    const V clamped = hn::Min(hn::Max(fraction, hn::Zero(d)), hn::Set(d, 1.0f));
    for (int axis = 0; axis < 3; ++axis) {
      towards[axis] = hn::Sub(to_middle[axis], hn::Mul(clamped, along[axis]));
    }
    const V nearest =
        hn::Min(hn::Min(dot(towards, corner[0]), dot(towards, corner[1])), dot(towards, corner[2]));
    const V at_from = dot(towards, from);
    const V farthest = hn::Max(at_from, hn::Add(at_from, dot(towards, along)));
    const V apart = hn::Sub(nearest, farthest);
    const V needed2 = hn::Mul(dot(towards, towards), hn::Set(d, screen.distance2));
    const auto clear = hn::And(hn::Gt(apart, hn::Zero(d)), hn::Gt(hn::Mul(apart, apart), needed2));
    std::uint8_t lanes[8] = {};
    hn::StoreMaskBits(d, hn::Not(clear), lanes);
    const std::uint32_t of_these = lanes[0] | static_cast<std::uint32_t>(lanes[1]) << 8;
    bits |= of_these << first;
  }
  return bits;
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(lanes_that_may_be_near);

NearScreen::NearScreen(const Vec3& start, const Vec3& end, double distance, double size) noexcept {
  const Vec3 way = end - start;
  const double length2 = way.squaredNorm();
  inverse2 = length2 > 0.0 ? static_cast<float>(1.0 / length2) : 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    from[axis] = static_cast<float>(start[axis]);
    along[axis] = static_cast<float>(way[axis]);
  }
  const double all = std::max(size, std::max(start.norm(), end.norm()));
  const double needed = std::max(distance, 0.0) + 64.0 * 0x1p-24 * all;
  distance2 = static_cast<float>(needed * needed * (1.0 + 1e-6));
}

std::uint32_t may_be_near(const NearBlock& block, const NearScreen& screen) noexcept {
  return HWY_DYNAMIC_DISPATCH(lanes_that_may_be_near)(block, screen);
}

}  // namespace keepout

#endif  // HWY_ONCE
