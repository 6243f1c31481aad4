// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "oriented_extent.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "index/oriented_extent.cpp"
#include <hwy/foreach_target.h>
// After it, for it tells for whom to compile.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

OrientedExtent extent_of(const PdNode& node, std::span<const LeafBlock> leaves) {
  const hn::CappedTag<float, LeafBlock::lanes> d;
  using Lanes = hn::Vec<decltype(d)>;
  Lanes low[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  Lanes high[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  for (const LeafBlock& leaf : leaves) {
    for (const auto& corner : leaf.corner) {
      for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(d)) {
        const Lanes x = hn::Sub(hn::Load(d, corner[0] + first), hn::Set(d, node.center[0]));
        const Lanes y = hn::Sub(hn::Load(d, corner[1] + first), hn::Set(d, node.center[1]));
        const Lanes z = hn::Sub(hn::Load(d, corner[2] + first), hn::Set(d, node.center[2]));
        for (std::size_t k = 0; k < 3; ++k) {
          const Lanes along = hn::Add(hn::Add(hn::Mul(x, hn::Set(d, node.across[0][k])),
                                              hn::Mul(y, hn::Set(d, node.across[1][k]))),
                                      hn::Mul(z, hn::Set(d, node.across[2][k])));
          low[k] = hn::Min(low[k], along);
          high[k] = hn::Max(high[k], along);
        }
      }
    }
  }
  OrientedExtent extent;
  for (std::size_t k = 0; k < 3; ++k) {
    extent.low[k] = hn::GetLane(hn::MinOfLanes(d, low[k]));
    extent.high[k] = hn::GetLane(hn::MaxOfLanes(d, high[k]));
  }
  return extent;
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(extent_of);

OrientedExtent oriented_extent(const PdNode& node, std::span<const LeafBlock> leaves) noexcept {
  return HWY_DYNAMIC_DISPATCH(extent_of)(node, leaves);
}

}  // namespace keepout

#endif  // HWY_ONCE
