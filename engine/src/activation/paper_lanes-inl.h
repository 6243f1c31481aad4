// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Sixteen triangles at a time, or as many as a vector holds: included once for each target.
#if defined(KEEPOUT_PAPER_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KEEPOUT_PAPER_LANES_INL_H
#undef KEEPOUT_PAPER_LANES_INL_H
#else
#define KEEPOUT_PAPER_LANES_INL_H
#endif

#include <hwy/highway.h>

#include "../lane_packing-inl.h"
#include "paper_screen.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::paper_lanes::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Float = hn::CappedTag<float, 16>;
using V = hn::Vec<Float>;
using M = hn::Mask<Float>;
using Unsigned = hn::RebindToUnsigned<Float>;
using VU = hn::Vec<Unsigned>;

constexpr float u = 0x1p-24f;
constexpr float tiny = 1e-30f;
constexpr float overflow = 1e18f;            // of squares
constexpr float outward = 1.0f + 32.0f * u;  // more than the rounding of a length

HWY_INLINE V times(float a, V b) { return hn::Mul(hn::Set(Float(), a), b); }
HWY_INLINE V plus(V a, V b) { return hn::Add(a, b); }
HWY_INLINE V minus(V a, V b) { return hn::Sub(a, b); }
HWY_INLINE V product(V a, V b) { return hn::Mul(a, b); }
HWY_INLINE V size(V a) { return hn::Abs(a); }

struct Vector {
  V x, y, z;
};

HWY_INLINE V dot(const Vector& a, const Vector& b) {
  return plus(plus(product(a.x, b.x), product(a.y, b.y)), product(a.z, b.z));
}

/// Points of a block, relative to the centre of the query.
HWY_INLINE Vector points(const float (&at)[3][LeafBlock::lanes], std::size_t lane,
                         const PaperQuery& query) {
  const Float d;
  const auto coordinate = [&](int axis) {
    return minus(minus(hn::Load(d, at[axis] + lane), hn::Set(d, query.high[axis])),
                 hn::Set(d, query.low[axis]));
  };
  return {coordinate(0), coordinate(1), coordinate(2)};
}

/// The bits of a mask, at the place of its lanes in the block.
HWY_INLINE std::uint32_t bits(M mask, std::size_t lane) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Float(), mask, bytes);
  return (bytes[0] | (std::uint32_t{bytes[1]} << 8)) << lane;
}

HWY_INLINE M has(VU flags, std::uint32_t flag) {
  return hn::RebindMask(Float(), hn::TestBit(flags, hn::Set(Unsigned(), flag)));
}

HWY_INLINE V select(M mask, V yes, V no) { return hn::IfThenElse(mask, yes, no); }
HWY_INLINE VU select(M mask, VU yes, VU no) {
  return hn::IfThenElse(hn::RebindMask(Unsigned(), mask), yes, no);
}

HWY_INLINE M either(M a, M b) { return hn::Or(a, b); }
HWY_INLINE M both(M a, M b) { return hn::And(a, b); }
HWY_INLINE M but_not(M a, M b) { return hn::AndNot(b, a); }

/// A quantity, and what rounding may have made of it.
struct Banded {
  V value;
  V band;
};

HWY_INLINE M is_positive(const Banded& a) { return hn::Gt(a.value, a.band); }
HWY_INLINE M is_negative(const Banded& a) { return hn::Lt(a.value, hn::Neg(a.band)); }
HWY_INLINE Banded select(M mask, const Banded& yes, const Banded& no) {
  return {select(mask, yes.value, no.value), select(mask, yes.band, no.band)};
}

using keepout::HWY_NAMESPACE::LanePacking;
HWY_INLINE LanePacking packing_of(M chosen) {
  return LanePacking(hn::RebindMask(Unsigned(), chosen));
}

/// Appends the chosen lanes.
HWY_INLINE void append(V values, const LanePacking& chosen, float* to) {
  hn::StoreU(chosen(values), Float(), to);
}
HWY_INLINE void append(VU values, const LanePacking& chosen, std::uint32_t* to) {
  hn::StoreU(chosen(values), Unsigned(), to);
}

HWY_INLINE VU flag_if(M mask, std::uint32_t flag) {
  const Unsigned du;
  return hn::IfThenElseZero(hn::RebindMask(du, mask), hn::Set(du, flag));
}

}  // namespace keepout::paper_lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
