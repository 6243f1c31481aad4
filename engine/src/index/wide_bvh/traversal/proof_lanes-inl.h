// SPDX-License-Identifier: BSD-3-Clause
//
// Proofs that a motion stays clear, each by a direction: sixteen lanes at a time.
//
// Rounding, in units of u = 2^-24. A coordinate relative to the tip is off by less than 3 u of
// itself, plus the error of the leaf's coordinate. A product n . v of three terms is off by 5 u |n|
// |v|, and the length of a unit vector by 3 u. The sum is below 16 u = 1e-6 of |v|, of the level
// and of the length of the motion. FloatLevels allows at least half as much again.
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

/// Returns the lanes of a vector at `lane` of the block whose bits are set in `mask`.
HWY_INLINE M lanes_of(FloatTag d, std::uint32_t mask, std::size_t lane) {
  const hn::RebindToUnsigned<FloatTag> du;
  const auto bit = hn::Shl(hn::Set(du, 1u), hn::Iota(du, static_cast<std::uint32_t>(lane)));
  return hn::RebindMask(d, hn::TestBit(hn::Set(du, mask), bit));
}

/// Returns a . b. Rounds once a term where the processor can, so the digits depend on it. Floats
/// only prove clearance, so steps do not.
HWY_INLINE V product(const Vector& a, const Vector& b) {
  return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, hn::Mul(a.x, b.x)));
}

/// Returns s a + b, rounded like product().
HWY_INLINE Vector sum_of(V s, const Vector& a, const Vector& b) {
  return {hn::MulAdd(s, a.x, b.x), hn::MulAdd(s, a.y, b.y), hn::MulAdd(s, a.z, b.z)};
}

/// Returns points of a block, relative to the tip.
template <std::size_t Lanes>
HWY_INLINE Vector relative(FloatTag d, const float (&from)[3][Lanes], std::size_t lane,
                           const FloatTip& tip) {
  return load(d, from, lane) - all(d, tip.high) - all(d, tip.low);
}

/// A unit vector for each lane, and the distance of the tip beyond the level that it proves.
struct Proof {
  Vector n;
  V clear;  // distance of the tip, minus level and rounding [length]
};

/// Returns a proof in the lanes whose direction is a unit vector. The other lanes prove nothing.
HWY_INLINE Proof proof_if(FloatTag d, M is_unit, const Vector& n, V clear) {
  const V zero = hn::Zero(d);
  return {select(is_unit, n, {zero, zero, zero}),
          hn::IfThenElse(is_unit, clear, hn::Set(d, -1e30f))};
}

/// Returns true if a vector of this squared length can be normalized. Smaller and larger squares
/// have lost their digits.
HWY_INLINE M has_direction(FloatTag d, V length2) {
  return hn::And(hn::Gt(length2, hn::Set(d, 1e-30f)), hn::Lt(length2, hn::Set(d, 1e30f)));
}

/// Returns the clearance that a unit vector proves for shapes with this support along it. `far`: no
/// point of a shape is farther from the tip.
HWY_INLINE V clear_of(FloatTag d, V support, V far, const FloatLevels& levels) {
  const V rounding = hn::MulAdd(far, hn::Set(d, levels.relative), hn::Set(d, levels.slack));
  return hn::Sub(hn::Sub(hn::Neg(support), hn::Set(d, levels.level)), rounding);
}

/// Returns the proof by the direction of `way`, or one that proves nothing if `way` has no
/// direction. `clear_along(d, shapes, n, levels)` returns the clearance that a unit vector proves.
template <class Shapes>
HWY_INLINE Proof proof_along(FloatTag d, const Shapes& shapes, const Vector& way,
                             const FloatLevels& levels) {
  const V length2 = product(way, way);
  const Vector n = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(length2)) * way;
  return proof_if(d, has_direction(d, length2), n, clear_along(d, shapes, n, levels));
}

HWY_INLINE Proof select(M mask, const Proof& yes, const Proof& no) {
  return {select(mask, yes.n, no.n), hn::IfThenElse(mask, yes.clear, no.clear)};
}

HWY_INLINE void store(FloatTag d, const Proof& proof, std::size_t lane, ProofBlock& to) {
  store(d, proof.n, lane, to.n);
  hn::Store(proof.clear, d, to.clear + lane);
}

HWY_INLINE Proof load(FloatTag d, const ProofBlock& from, std::size_t lane) {
  return {load(d, from.n, lane), hn::Load(d, from.clear + lane)};
}

/// Returns true if the proof holds for the whole motion; false for NaN. `along`: n . z.
HWY_INLINE M holds(FloatTag d, const Proof& proof, V along) {
  const V zero = hn::Zero(d);
  return hn::And(hn::Ge(proof.clear, zero), hn::Ge(hn::Add(proof.clear, along), zero));
}

// Makes a time early by more than the rounding of its quotient.
constexpr float never_late = 0.999999f;

/// Returns the time at which a motion that comes nearer along the normal may reach the level.
/// Returns -1e30 if the tip may be within the level, or if the motion does not come nearer.
/// `along`: n . z.
HWY_INLINE V entry(FloatTag d, const Proof& proof, V along) {
  const V zero = hn::Zero(d);
  const V time = hn::Mul(hn::Div(proof.clear, hn::Neg(along)), hn::Set(d, never_late));
  const M falls = hn::And(hn::Ge(proof.clear, zero), hn::Lt(along, zero));
  return hn::IfThenElse(falls, time, hn::Set(d, -1e30f));
}

/// Returns true if the proof holds from a time of the motion on. `along`: n . z.
HWY_INLINE M stays(FloatTag d, const Proof& proof, V along, V time) {
  const V zero = hn::Zero(d);
  return hn::And(hn::Ge(along, zero), hn::Ge(hn::MulAdd(time, along, proof.clear), zero));
}

/// Returns the time from which on a motion that moves away along the normal is surely beyond the
/// level. Returns 1e30 if it comes nearer, or if its end may be within the level. `along`: n . z.
HWY_INLINE V leaving(FloatTag d, const Proof& proof, V along) {
  const V zero = hn::Zero(d);
  const V time = hn::Mul(hn::Div(hn::Neg(proof.clear), along), hn::Set(d, 2.0f - never_late));
  const M rises = hn::And(hn::Gt(along, zero), hn::Ge(hn::Add(proof.clear, along), zero));
  return hn::IfThenElse(rises, time, hn::Set(d, 1e30f));
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
