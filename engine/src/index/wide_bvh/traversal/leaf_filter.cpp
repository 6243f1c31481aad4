// SPDX-License-Identifier: BSD-3-Clause
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "index/wide_bvh/traversal/leaf_filter.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which sets the target to compile for.
#include "filters.h"
#include "proof_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

/// Returns triangles of a leaf relative to the tip.
HWY_INLINE TriangleLanes corners(FloatTag d, const LeafBlock& leaf, const FloatTip& tip,
                                 std::size_t lane) {
  return {relative(d, leaf.corner[0], lane, tip), relative(d, leaf.corner[1], lane, tip),
          relative(d, leaf.corner[2], lane, tip)};
}

/// Returns approximately the point of each triangle that is nearest to p. (Differs from
/// nearest_point() of leaf_test-inl.h, which has a proved error: here any point gives a valid
/// proof.) Source: Ericson, "Real-Time Collision Detection", 2005, section 5.1.5.
HWY_INLINE Vector nearest(FloatTag d, const TriangleLanes& t, const Vector& p) {
  const V zero = hn::Zero(d);
  const Vector ab = t.b - t.a;
  const Vector ac = t.c - t.a;
  const Vector ap = p - t.a;
  const Vector bp = p - t.b;
  const Vector cp = p - t.c;
  const V d1 = dot(ab, ap), d2 = dot(ac, ap);
  const V d3 = dot(ab, bp), d4 = dot(ac, bp);
  const V d5 = dot(ab, cp), d6 = dot(ac, cp);
  const V va = hn::Sub(hn::Mul(d3, d6), hn::Mul(d5, d4));
  const V vb = hn::Sub(hn::Mul(d5, d2), hn::Mul(d1, d6));
  const V vc = hn::Sub(hn::Mul(d1, d4), hn::Mul(d3, d2));
  const V along_bc = hn::Sub(d4, d3);
  const V along_cb = hn::Sub(d5, d6);

  // v and w of a + v ab + w ac, each times `whole`; the last condition that is true decides.
  V v = vb, w = vc, whole = hn::Add(hn::Add(va, vb), vc);
  const auto take = [&](M where, V new_v, V new_w, V new_whole) {
    v = hn::IfThenElse(where, new_v, v);
    w = hn::IfThenElse(where, new_w, w);
    whole = hn::IfThenElse(where, new_whole, whole);
  };
  const auto edge = [&](V beyond, V from, V to) {
    return hn::And(hn::Le(beyond, zero), hn::And(hn::Ge(from, zero), hn::Ge(to, zero)));
  };
  const V one = hn::Set(d, 1.0f);
  take(edge(va, along_bc, along_cb), along_cb, along_bc, hn::Add(along_bc, along_cb));
  take(edge(vb, d2, hn::Neg(d6)), zero, d2, hn::Sub(d2, d6));
  take(edge(vc, d1, hn::Neg(d3)), d1, zero, hn::Sub(d1, d3));
  take(hn::And(hn::Ge(d6, zero), hn::Le(d5, d6)), zero, one, one);
  take(hn::And(hn::Ge(d3, zero), hn::Le(d4, d3)), one, zero, one);
  take(hn::And(hn::Le(d1, zero), hn::Le(d2, zero)), zero, zero, one);
  const V share = hn::Div(one, whole);
  return t.a + (hn::Mul(v, share) * ab + hn::Mul(w, share) * ac);
}

/// Returns the clearance that a unit vector proves.
HWY_INLINE V clear_along(FloatTag d, const TriangleLanes& t, const Vector& n,
                         const FloatLevels& levels) {
  const V support = hn::Max(dot(n, t.a), hn::Max(dot(n, t.b), dot(n, t.c)));
  const V far = hn::Max(norm1(t.a), hn::Max(norm1(t.b), norm1(t.c)));
  return clear_of(d, support, far, levels);
}

HWY_INLINE Proof proof_at(FloatTag d, const TriangleLanes& t, const Vector& p,
                          const FloatLevels& levels) {
  return proof_along(d, t, p - nearest(d, t, p), levels);
}

void FillFilter(const LeafBlock& leaf, const FloatTip& tip, const FloatLevels& levels,
                LeafFilter& filter) {
  const FloatTag d;
  const V zero = hn::Zero(d);
  for (std::size_t lane = 0; lane < LeafBlock::lanes; lane += hn::Lanes(d)) {
    const TriangleLanes t = corners(d, leaf, tip, lane);
    const Proof proof = proof_at(d, t, {zero, zero, zero}, levels);
    store(d, proof, lane, filter.at_tip);
    store(d, proof, lane, filter.last);
  }
}

void FindSuspects(const LeafFilter& filter, const float* motion, Suspects& suspects) {
  const FloatTag d;
  const Vector z = all(d, motion);
  suspects.mask = 0;
  for (std::size_t lane = 0; lane < LeafBlock::lanes; lane += hn::Lanes(d)) {
    const Proof first = load(d, filter.at_tip, lane);
    const Proof last = load(d, filter.last, lane);
    const V along_first = dot(first.n, z);
    const V along_last = dot(last.n, z);
    const M clear = hn::Or(holds(d, first, along_first), holds(d, last, along_last));
    hn::Store(hn::Max(entry(d, first, along_first), entry(d, last, along_last)), d,
              suspects.time + lane);
    suspects.mask |= bits(d, hn::Not(clear), lane);
  }
}

/// Returns the lanes of a vector at `lane` of the block whose bits are set in `mask`.
HWY_INLINE M lanes_of(FloatTag d, std::uint32_t mask, std::size_t lane) {
  const hn::RebindToUnsigned<FloatTag> du;
  const auto bit = hn::Shl(hn::Set(du, 1u), hn::Iota(du, static_cast<std::uint32_t>(lane)));
  return hn::RebindMask(d, hn::TestBit(hn::Set(du, mask), bit));
}

/// Returns the suspects of a vector with a time up to `latest`; the others are not worth
/// sharpening.
HWY_INLINE M in_time(FloatTag d, const Suspects& suspects, V time, float latest, std::size_t lane) {
  return hn::And(lanes_of(d, suspects.mask, lane), hn::Le(time, hn::Set(d, latest)));
}

void SharpenSuspects(const LeafBlock& leaf, const FloatTip& tip, const float* motion,
                     const FloatLevels& levels, float latest, LeafFilter& filter,
                     Suspects& suspects) {
  constexpr int cuts = 2;
  const FloatTag d;
  const Vector z = all(d, motion);
  const V zero = hn::Zero(d);
  const V one = hn::Set(d, 1.0f);
  std::uint32_t proven = 0;
  for (std::size_t lane = 0; lane < LeafBlock::lanes; lane += hn::Lanes(d)) {
    V time = hn::Load(d, suspects.time + lane);
    M asked = in_time(d, suspects, time, latest, lane);
    if (hn::AllFalse(d, asked)) continue;
    Proof left = load(d, filter.at_tip, lane);
    V fall = dot(left.n, z);
    Proof best = load(d, filter.last, lane);
    M clear = hn::Or(holds(d, left, fall), holds(d, best, dot(best.n, z)));
    const TriangleLanes t = corners(d, leaf, tip, lane);
    const auto consider = [&](const Proof& proof, V along) {
      const M better = hn::AndNot(clear, holds(d, proof, along));
      best = select(better, proof, best);
      clear = hn::Or(clear, better);
      time = hn::Max(time, entry(d, proof, along));
    };
    Proof right = proof_at(d, t, z, levels);
    V rise = dot(right.n, z);
    consider(right, rise);
    // A motion that ends too close has no proof.
    asked = hn::AndNot(hn::Lt(hn::Add(right.clear, rise), zero), asked);
    for (int cut = 0; cut < cuts; ++cut) {
      asked = hn::AndNot(hn::Or(clear, hn::Gt(time, hn::Set(d, latest))), asked);
      if (hn::AllFalse(d, asked)) break;
      // The blend that is level along the motion, and the normal at the time when the two lines
      // cross.
      const Proof blend = proof_along(d, t, rise * left.n - fall * right.n, levels);
      consider(blend, dot(blend.n, z));
      const V crossing = hn::Div(hn::Sub(left.clear, right.clear), hn::Sub(rise, fall));
      const V at = hn::Min(hn::Max(crossing, zero), one);
      const Proof next = proof_at(d, t, at * z, levels);
      const V along = dot(next.n, z);
      consider(next, along);
      const M falls = hn::Lt(along, zero);
      left = select(falls, next, left);
      fall = hn::IfThenElse(falls, along, fall);
      right = select(falls, right, next);
      rise = hn::IfThenElse(falls, rise, along);
    }
    store(d, best, lane, filter.last);
    hn::Store(time, d, suspects.time + lane);
    proven |= bits(d, clear, lane);
  }
  suspects.mask &= ~proven;
}

void DelaySuspects(const LeafBlock& leaf, const FloatTip& tip, const float* motion,
                   const FloatLevels& levels, float latest, Suspects& suspects) {
  const FloatTag d;
  const Vector z = all(d, motion);
  std::uint32_t proven = 0;
  for (std::size_t lane = 0; lane < LeafBlock::lanes; lane += hn::Lanes(d)) {
    const V time = hn::Load(d, suspects.time + lane);
    if (hn::AllFalse(d, in_time(d, suspects, time, latest, lane))) continue;
    const V at = hn::Min(hn::Max(time, hn::Zero(d)), hn::Set(d, 1.0f));
    const Proof proof = proof_at(d, corners(d, leaf, tip, lane), at * z, levels);
    const V along = dot(proof.n, z);
    hn::Store(hn::Max(time, entry(d, proof, along)), d, suspects.time + lane);
    proven |= bits(d, holds(d, proof, along), lane);
  }
  suspects.mask &= ~proven;
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(FillFilter);
HWY_EXPORT(FindSuspects);
HWY_EXPORT(SharpenSuspects);
HWY_EXPORT(DelaySuspects);

void fill_filter(const LeafBlock& leaf, const FloatTip& tip, const FloatLevels& levels,
                 LeafFilter& filter) noexcept {
  HWY_DYNAMIC_DISPATCH(FillFilter)(leaf, tip, levels, filter);
}

void find_suspects(const LeafFilter& filter, const float* motion, Suspects& suspects) noexcept {
  HWY_DYNAMIC_DISPATCH(FindSuspects)(filter, motion, suspects);
}

void sharpen_suspects(const LeafBlock& leaf, const FloatTip& tip, const float* motion,
                      const FloatLevels& levels, float latest, LeafFilter& filter,
                      Suspects& suspects) noexcept {
  HWY_DYNAMIC_DISPATCH(SharpenSuspects)(leaf, tip, motion, levels, latest, filter, suspects);
}

void delay_suspects(const LeafBlock& leaf, const FloatTip& tip, const float* motion,
                    const FloatLevels& levels, float latest, Suspects& suspects) noexcept {
  HWY_DYNAMIC_DISPATCH(DelaySuspects)(leaf, tip, motion, levels, latest, suspects);
}

}  // namespace keepout

#endif
