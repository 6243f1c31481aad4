// SPDX-License-Identifier: BSD-3-Clause
//
// What a direction proves of a motion, sixteen lanes at a time.
//
// Rounding. In units of u = 2^-24: a coordinate relative to the tip is off by less than 3 u of
// itself, and by the error of the leaf's own; a product n . v of three terms by 5 u |n| |v|; the
// length of a unit vector by 3 u. Together they stay below 16 u = 1e-6 of |v|, of the level and of
// the length of the motion; FloatReach takes half as much again, or more.
#if defined(KEEPOUT_PROOF_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KEEPOUT_PROOF_LANES_INL_H
#undef KEEPOUT_PROOF_LANES_INL_H
#else
#define KEEPOUT_PROOF_LANES_INL_H
#endif

#include "../../../lanes-inl.h"
#include "filters.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

/// Points of a block, relative to the tip.
template <std::size_t Lanes>
HWY_INLINE Vector relative(Float d, const float (&from)[3][Lanes], std::size_t lane,
                           const FloatTip& tip) {
  return load(d, from, lane) - all(d, tip.high) - all(d, tip.low);
}

/// A unit vector for each lane, and what it proves: that the tip is so much beyond the level along
/// it.
struct Proof {
  Vector n;
  V clear;  // distance of the tip less the level and rounding [length]
};

/// What holds wherever the direction has digits enough to be of unit length; elsewhere nothing.
HWY_INLINE Proof proof_if(Float d, M is_unit, const Vector& n, V clear) {
  const V zero = hn::Zero(d);
  return {select(is_unit, n, {zero, zero, zero}),
          hn::IfThenElse(is_unit, clear, hn::Set(d, -1e30f))};
}

/// Whether a vector of this squared length can be made one of unit length: below, and above, the
/// squares have lost their digits.
HWY_INLINE M has_direction(Float d, V length2) {
  return hn::And(hn::Gt(length2, hn::Set(d, 1e-30f)), hn::Lt(length2, hn::Set(d, 1e30f)));
}

/// What a unit vector proves of things that reach so far along it, and of which nothing is farther
/// from the tip than `far`.
HWY_INLINE V clear_of(Float d, V support, V far, const FloatReach& reach) {
  const V rounding = hn::Add(hn::Mul(far, hn::Set(d, reach.relative)), hn::Set(d, reach.slack));
  return hn::Sub(hn::Sub(hn::Neg(support), hn::Set(d, reach.level)), rounding);
}

/// What the direction of `way` proves; nothing, if it is none. `clear_along(d, shapes, n, reach)`
/// tells what a unit vector proves of the shapes.
template <class Shapes>
HWY_INLINE Proof proof_along(Float d, const Shapes& shapes, const Vector& way,
                             const FloatReach& reach) {
  const V length2 = dot(way, way);
  const Vector n = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(length2)) * way;
  return proof_if(d, has_direction(d, length2), n, clear_along(d, shapes, n, reach));
}

HWY_INLINE Proof select(M mask, const Proof& yes, const Proof& no) {
  return {select(mask, yes.n, no.n), hn::IfThenElse(mask, yes.clear, no.clear)};
}

HWY_INLINE void store(Float d, const Proof& proof, std::size_t lane, ProofBlock& to) {
  store(d, proof.n, lane, to.n);
  hn::Store(proof.clear, d, to.clear + lane);
}

HWY_INLINE Proof load(Float d, const ProofBlock& from, std::size_t lane) {
  return {load(d, from.n, lane), hn::Load(d, from.clear + lane)};
}

/// Whether the proof holds for the whole motion. Not for NaN.
HWY_INLINE M holds(Float d, const Proof& proof, V along) {
  const V zero = hn::Zero(d);
  return hn::And(hn::Ge(proof.clear, zero), hn::Ge(hn::Add(proof.clear, along), zero));
}

/// When a motion that comes nearer along the normal may be there; `along` is n . z.
HWY_INLINE V entry(Float d, const Proof& proof, V along) {
  const V zero = hn::Zero(d);
  const V time = hn::Mul(hn::Div(proof.clear, hn::Neg(along)), hn::Set(d, 0.999999f));
  const M falls = hn::And(hn::Ge(proof.clear, zero), hn::Lt(along, zero));
  return hn::IfThenElse(falls, time, hn::Set(d, -1e30f));
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
