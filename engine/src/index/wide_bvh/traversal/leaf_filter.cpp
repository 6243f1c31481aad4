// SPDX-License-Identifier: BSD-3-Clause
#include <bit>
#include <limits>

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
  const V d1 = product(ab, ap), d2 = product(ac, ap);
  const V d3 = product(ab, bp), d4 = product(ac, bp);
  const V d5 = product(ab, cp), d6 = product(ac, cp);
  const V va = hn::MulSub(d3, d6, hn::Mul(d5, d4));
  const V vb = hn::MulSub(d5, d2, hn::Mul(d1, d6));
  const V vc = hn::MulSub(d1, d4, hn::Mul(d3, d2));
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
  return sum_of(hn::Mul(v, share), ab, sum_of(hn::Mul(w, share), ac, t.a));
}

/// Returns the clearance that a unit vector proves.
HWY_INLINE V clear_along(FloatTag d, const TriangleLanes& t, const Vector& n,
                         const FloatLevels& levels) {
  const V support = hn::Max(product(n, t.a), hn::Max(product(n, t.b), product(n, t.c)));
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
  const hn::RebindToUnsigned<FloatTag> du;
  const V zero = hn::Zero(d);
  const V always = hn::Set(d, 1e30f);
  for (std::size_t lane = 0; lane < LeafBlock::lanes; lane += hn::Lanes(d)) {
    const TriangleLanes t = corners(d, leaf, tip, lane);
    Proof proof = proof_at(d, t, {zero, zero, zero}, levels);
    const auto is_unused =
        hn::Eq(hn::Load(du, leaf.tagged_triangle + lane), hn::Set(du, no_triangle));
    const M unused = hn::RebindMask(d, is_unused);
    proof = {select(unused, {zero, zero, zero}, proof.n),
             hn::IfThenElse(unused, always, proof.clear)};
    store(d, proof, lane, filter.at_tip);
  }
  filter.has_last = false;
}

/// Returns the suspect of least time, the first one if several have it. Precondition: there is one.
HWY_INLINE std::uint32_t earliest_of(FloatTag d, const Suspects& suspects) {
  const auto time_at = [&](std::size_t lane) HWY_ATTR {
    return hn::IfThenElse(lanes_of(d, suspects.mask, lane), hn::Load(d, suspects.time + lane),
                          hn::Set(d, std::numeric_limits<float>::infinity()));
  };
  V least = time_at(0);
  for (std::size_t lane = hn::Lanes(d); lane < LeafBlock::lanes; lane += hn::Lanes(d)) {
    least = hn::Min(least, time_at(lane));
  }
  least = hn::MinOfLanes(d, least);
  std::uint32_t found = 0;
  for (std::size_t lane = 0; lane < LeafBlock::lanes; lane += hn::Lanes(d)) {
    found |= bits(d, hn::Eq(time_at(lane), least), lane);
  }
  return static_cast<std::uint32_t>(std::countr_zero(found & suspects.mask));
}

std::uint32_t FindSuspects(const LeafFilter& filter, const float* motion, float latest,
                           Suspects& suspects) {
  const FloatTag d;
  const Vector z = all(d, motion);
  const V until = hn::Set(d, latest);
  std::uint32_t begun = 0;
  suspects.mask = 0;
  for (std::size_t lane = 0; lane < LeafBlock::lanes; lane += hn::Lanes(d)) {
    const Proof first = load(d, filter.at_tip, lane);
    const V along_first = product(first.n, z);
    M clear = holds(d, first, along_first);
    V time = entry(d, first, along_first);
    if (filter.has_last) {
      const Proof last = load(d, filter.last, lane);
      const V along = product(last.n, z);
      time = hn::Max(time, entry(d, last, along));
      clear = hn::Or(hn::Or(clear, holds(d, last, along)), hn::Le(leaving(d, last, along), time));
    }
    hn::Store(time, d, suspects.time + lane);
    const M later = hn::Gt(time, hn::Zero(d));
    begun |= bits(d, hn::Not(hn::Or(clear, later)), lane);
    suspects.mask |= bits(d, hn::AndNot(clear, hn::And(later, hn::Le(time, until))), lane);
  }
  if (suspects.mask != 0) suspects.earliest = earliest_of(d, suspects);
  return begun;
}

void SharpenSuspects(const LeafBlock& leaf, const FloatTip& tip, const float* motion,
                     const FloatLevels& levels, float latest, int steps, LeafFilter& filter,
                     Suspects& suspects) {
  const FloatTag d;
  const Vector z = all(d, motion);
  const V zero = hn::Zero(d);
  const V until = hn::Min(hn::Set(d, latest), hn::Set(d, 1.0f));
  std::uint32_t proven = 0;
  for (std::size_t lane = 0; lane < LeafBlock::lanes; lane += hn::Lanes(d)) {
    M asked = lanes_of(d, suspects.mask, lane);
    Proof last = load(d, filter.has_last ? filter.last : filter.at_tip, lane);
    if (hn::AllFalse(d, asked)) {
      if (!filter.has_last) store(d, last, lane, filter.last);
      continue;
    }
    V time = hn::Load(d, suspects.time + lane);
    const TriangleLanes t = corners(d, leaf, tip, lane);
    M clear = hn::Gt(time, until);
    for (int step = 0; step < steps; ++step) {
      asked = hn::AndNot(clear, asked);
      if (hn::AllFalse(d, asked)) break;
      // The motion is clear up to this time. A proof that holds here and does not fall proves the
      // rest.
      const V at = hn::Min(hn::Max(time, zero), until);
      const Proof proof = proof_at(d, t, at * z, levels);
      const V along = product(proof.n, z);
      time = hn::Max(time, entry(d, proof, along));
      clear = hn::Or(clear, hn::Or(stays(d, proof, along, at), hn::Gt(time, until)));
      last = select(asked, proof, last);
    }
    store(d, last, lane, filter.last);
    hn::Store(time, d, suspects.time + lane);
    proven |= bits(d, clear, lane);
  }
  filter.has_last = true;
  suspects.mask &= ~proven;
  if (suspects.mask != 0) suspects.earliest = earliest_of(d, suspects);
}

void RemoveSuspect(Suspects& suspects, std::uint32_t lane) {
  suspects.mask &= ~(std::uint32_t{1} << lane);
  if (suspects.mask != 0) suspects.earliest = earliest_of(FloatTag(), suspects);
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(FillFilter);
HWY_EXPORT(FindSuspects);
HWY_EXPORT(SharpenSuspects);
HWY_EXPORT(RemoveSuspect);

void fill_filter(const LeafBlock& leaf, const FloatTip& tip, const FloatLevels& levels,
                 LeafFilter& filter) noexcept {
  HWY_DYNAMIC_DISPATCH(FillFilter)(leaf, tip, levels, filter);
}

std::uint32_t find_suspects(const LeafFilter& filter, const float* motion, float latest,
                            Suspects& suspects) noexcept {
  return HWY_DYNAMIC_DISPATCH(FindSuspects)(filter, motion, latest, suspects);
}

void sharpen_suspects(const LeafBlock& leaf, const FloatTip& tip, const float* motion,
                      const FloatLevels& levels, float latest, int steps, LeafFilter& filter,
                      Suspects& suspects) noexcept {
  HWY_DYNAMIC_DISPATCH(SharpenSuspects)
  (leaf, tip, motion, levels, latest, steps, filter, suspects);
}

void Suspects::remove(std::uint32_t lane) noexcept {
  HWY_DYNAMIC_DISPATCH(RemoveSuspect)(*this, lane);
}

}  // namespace keepout

#endif
