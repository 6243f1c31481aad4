// SPDX-License-Identifier: BSD-3-Clause
//
// Moves chosen lanes to the front. Included once for each SIMD target: see foreach_target.h of
// Highway.

#ifndef KEEPOUT_LANE_ORDERS
#define KEEPOUT_LANE_ORDERS

#include <array>
#include <cstddef>
#include <cstdint>

namespace keepout {

/// For each choice of lanes, one bit each: the numbers of the chosen lanes, then of the others. It
/// is not in the function that reads it, because GCC 12 would then copy it to the stack each time.
template <std::size_t Lanes>
alignas(64) inline constexpr auto lane_orders = [] {
  std::array<std::array<std::uint8_t, Lanes>, std::size_t{1} << Lanes> orders{};
  for (std::size_t choice = 0; choice < orders.size(); ++choice) {
    std::size_t place = 0;
    for (const std::size_t wanted : {1u, 0u}) {
      for (std::size_t lane = 0; lane < Lanes; ++lane) {
        if ((choice >> lane & 1u) == wanted) {
          orders[choice][place++] = static_cast<std::uint8_t>(lane);
        }
      }
    }
  }
  return orders;
}();

}  // namespace keepout

#endif

#if defined(KEEPOUT_LANE_PACKING_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KEEPOUT_LANE_PACKING_INL_H
#undef KEEPOUT_LANE_PACKING_INL_H
#else
#define KEEPOUT_LANE_PACKING_INL_H
#endif

#include <hwy/highway.h>

// Does the work of hn::Compress, which is one instruction on AVX-512. Other targets use a table.
// Highway 1.0 declares its table in a function, so this file has its own.
#undef KEEPOUT_PACKS_BY_TABLE
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_SSSE3
#define KEEPOUT_PACKS_BY_TABLE 1
#else
#define KEEPOUT_PACKS_BY_TABLE 0
#endif

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// A choice of 32-bit lanes, found once and applied to any number of vectors.
class LanePacking {
 public:
  using Tag = hn::CappedTag<std::uint32_t, 16>;

  HWY_INLINE explicit LanePacking(hn::Mask<Tag> chosen) : count_(hn::CountTrue(Tag(), chosen)) {
#if KEEPOUT_PACKS_BY_TABLE
    const Tag d;
    std::uint8_t choice[8] = {};
    hn::StoreMaskBits(d, chosen, choice);
    const hn::Rebind<std::uint8_t, Tag> bytes;
    how_ = hn::PromoteTo(d, hn::LoadU(bytes, lane_orders<hn::MaxLanes(Tag())>[choice[0]].data()));
#else
    how_ = chosen;
#endif
  }

  /// Returns the number of chosen lanes.
  HWY_INLINE std::size_t count() const { return count_; }

  /// Returns the chosen lanes in their order; the other lanes are undefined.
  template <class V>
  HWY_INLINE V operator()(V values) const {
    const hn::DFromV<V> d;
#if KEEPOUT_PACKS_BY_TABLE
    return hn::TableLookupLanes(values, hn::IndicesFromVec(d, how_));
#else
    return hn::Compress(values, hn::RebindMask(d, how_));
#endif
  }

 private:
#if KEEPOUT_PACKS_BY_TABLE
  hn::Vec<Tag> how_;  // the source of each lane
#else
  hn::Mask<Tag> how_;  // the chosen lanes
#endif
  std::size_t count_;
};

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
