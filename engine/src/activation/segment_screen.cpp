// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Rounding. In units of u = 2^-24: a coordinate relative to the tip is off by less than 3 u of
// itself, and by the error of the leaf's own; a product n . v of three terms by 5 u |n| |v|; the
// length of a unit vector by 3 u. Together they stay below 16 u = 1e-6 of |v|, of the margin and of
// the length of the motion; FloatReach takes half as much again, or more.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "activation/segment_screen.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

#include "segment_screen.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::segment_lanes::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Float = hn::CappedTag<float, 16>;
using V = hn::Vec<Float>;
using M = hn::Mask<Float>;

struct Vector {
  V x, y, z;
};

HWY_INLINE Vector operator-(const Vector& a, const Vector& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

HWY_INLINE Vector operator*(V s, const Vector& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}

HWY_INLINE Vector operator+(const Vector& a, const Vector& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}

HWY_INLINE V dot(const Vector& a, const Vector& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

/// The sum of the coordinates' sizes: a bound of the length.
HWY_INLINE V size(const Vector& a) {
  return hn::Add(hn::Add(hn::Abs(a.x), hn::Abs(a.y)), hn::Abs(a.z));
}

HWY_INLINE Vector all(Float d, const float* v) {
  return {hn::Set(d, v[0]), hn::Set(d, v[1]), hn::Set(d, v[2])};
}

HWY_INLINE Vector select(M mask, const Vector& yes, const Vector& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}

HWY_INLINE std::uint32_t bits(Float d, M mask, std::size_t lane) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return static_cast<std::uint32_t>(bytes[0] | (bytes[1] << 8)) << lane;
}

/// Triangles, relative to the tip.
struct Corners {
  Vector a, b, c;
};

HWY_INLINE Corners corners(Float d, const LeafBlock& leaf, const FloatTip& tip, std::size_t lane) {
  const auto coordinate = [&](std::size_t corner, std::size_t axis) {
    const V v = hn::Load(d, leaf.corner[corner][axis] + lane);
    return hn::Sub(hn::Sub(v, hn::Set(d, tip.high[axis])), hn::Set(d, tip.low[axis]));
  };
  const auto corner = [&](std::size_t i) -> Vector {
    return {coordinate(i, 0), coordinate(i, 1), coordinate(i, 2)};
  };
  return {corner(0), corner(1), corner(2)};
}

/// About the point of each triangle that is nearest to p.
/// Source: Ericson, "Real-Time Collision Detection", 2005, section 5.1.5.
HWY_INLINE Vector nearest(Float d, const Corners& t, const Vector& p) {
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

  // v and w of a + v ab + w ac, each over `whole`; the last that applies counts.
  V v = vb, w = vc, whole = hn::Add(hn::Add(va, vb), vc);
  const auto take = [&](M where, V its_v, V its_w, V its_whole) {
    v = hn::IfThenElse(where, its_v, v);
    w = hn::IfThenElse(where, its_w, w);
    whole = hn::IfThenElse(where, its_whole, whole);
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

/// A unit vector for each triangle, and what it proves.
struct Proof {
  Vector n;
  V clear;  // of the margin, at the tip
};

/// What the direction of `way` proves; nothing, if it is none.
HWY_INLINE Proof proof_along(Float d, const Corners& t, const Vector& way,
                             const FloatReach& reach) {
  const V length2 = dot(way, way);
  // Below, and above, the squares have lost their digits, and the vector is not of unit length.
  const M is_unit =
      hn::And(hn::Gt(length2, hn::Set(d, 1e-30f)), hn::Lt(length2, hn::Set(d, 1e30f)));
  const Vector n = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(length2)) * way;
  const V support = hn::Max(dot(n, t.a), hn::Max(dot(n, t.b), dot(n, t.c)));
  const V far = hn::Max(size(t.a), hn::Max(size(t.b), size(t.c)));
  const V rounding = hn::Add(hn::Mul(far, hn::Set(d, reach.relative)), hn::Set(d, reach.slack));
  const V clear = hn::Sub(hn::Sub(hn::Neg(support), hn::Set(d, reach.margin)), rounding);
  const V nothing = hn::Set(d, -1e30f);
  const V zero = hn::Zero(d);
  return {select(is_unit, n, {zero, zero, zero}), hn::IfThenElse(is_unit, clear, nothing)};
}

HWY_INLINE Proof proof_at(Float d, const Corners& t, const Vector& p, const FloatReach& reach) {
  return proof_along(d, t, p - nearest(d, t, p), reach);
}

HWY_INLINE void store(Float d, const Proof& proof, std::size_t lane, LeafScreen::Normals& to) {
  hn::Store(proof.n.x, d, to.n[0] + lane);
  hn::Store(proof.n.y, d, to.n[1] + lane);
  hn::Store(proof.n.z, d, to.n[2] + lane);
  hn::Store(proof.clear, d, to.clear + lane);
}

HWY_INLINE Proof load(Float d, const LeafScreen::Normals& from, std::size_t lane) {
  return {
      {hn::Load(d, from.n[0] + lane), hn::Load(d, from.n[1] + lane), hn::Load(d, from.n[2] + lane)},
      hn::Load(d, from.clear + lane)};
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

void Look(const LeafBlock& leaf, const FloatTip& tip, const FloatReach& reach, LeafScreen& screen) {
  const Float d;
  const V zero = hn::Zero(d);
  for (std::size_t lane = 0; lane < LeafBlock::lanes; lane += hn::Lanes(d)) {
    const Corners t = corners(d, leaf, tip, lane);
    const Proof proof = proof_at(d, t, {zero, zero, zero}, reach);
    store(d, proof, lane, screen.at_tip);
    store(d, proof, lane, screen.last);
  }
}

void Suspect(const LeafScreen& screen, const float* motion, Suspects& suspects) {
  const Float d;
  const Vector z = all(d, motion);
  suspects.mask = 0;
  for (std::size_t lane = 0; lane < LeafBlock::lanes; lane += hn::Lanes(d)) {
    const Proof first = load(d, screen.at_tip, lane);
    const Proof last = load(d, screen.last, lane);
    const V along_first = dot(first.n, z);
    const V along_last = dot(last.n, z);
    const M clear = hn::Or(holds(d, first, along_first), holds(d, last, along_last));
    hn::Store(hn::Max(entry(d, first, along_first), entry(d, last, along_last)), d,
              suspects.time + lane);
    suspects.mask |= bits(d, hn::Not(clear), lane);
  }
}

void SuspectSharply(const LeafBlock& leaf, const FloatTip& tip, const float* motion,
                    const FloatReach& reach, LeafScreen& screen, Suspects& suspects) {
  constexpr int cuts = 2;
  const Float d;
  const Vector z = all(d, motion);
  const V zero = hn::Zero(d);
  const V one = hn::Set(d, 1.0f);
  suspects.mask = 0;
  for (std::size_t lane = 0; lane < LeafBlock::lanes; lane += hn::Lanes(d)) {
    const Corners t = corners(d, leaf, tip, lane);
    Proof left = load(d, screen.at_tip, lane);
    V fall = dot(left.n, z);
    Proof best = load(d, screen.last, lane);
    M clear = hn::Or(holds(d, left, fall), holds(d, best, dot(best.n, z)));
    V time = hn::Max(entry(d, left, fall), entry(d, best, dot(best.n, z)));
    const auto consider = [&](const Proof& proof, V along) {
      const M better = hn::AndNot(clear, holds(d, proof, along));
      best = {select(better, proof.n, best.n), hn::IfThenElse(better, proof.clear, best.clear)};
      clear = hn::Or(clear, better);
      time = hn::Max(time, entry(d, proof, along));
    };
    Proof right = proof_at(d, t, z, reach);
    V rise = dot(right.n, z);
    consider(right, rise);
    for (int cut = 0; cut < cuts && !hn::AllTrue(d, clear); ++cut) {
      // The blend that is level along the motion, and the normal where the two lines cross.
      const Proof blend = proof_along(d, t, rise * left.n - fall * right.n, reach);
      consider(blend, dot(blend.n, z));
      const V crossing = hn::Div(hn::Sub(left.clear, right.clear), hn::Sub(rise, fall));
      const V at = hn::Min(hn::Max(crossing, zero), one);
      const Proof next = proof_at(d, t, at * z, reach);
      const V along = dot(next.n, z);
      consider(next, along);
      const M falls = hn::Lt(along, zero);
      left = {select(falls, next.n, left.n), hn::IfThenElse(falls, next.clear, left.clear)};
      fall = hn::IfThenElse(falls, along, fall);
      right = {select(falls, right.n, next.n), hn::IfThenElse(falls, right.clear, next.clear)};
      rise = hn::IfThenElse(falls, rise, along);
    }
    store(d, best, lane, screen.last);
    hn::Store(time, d, suspects.time + lane);
    suspects.mask |= bits(d, hn::Not(clear), lane);
  }
}

/// Boxes, relative to the tip.
struct Boxes {
  Vector low, high;
};

HWY_INLINE Boxes boxes_at(Float d, const NodeBlock& node, const FloatTip& tip, std::size_t lane) {
  const auto side = [&](const float(&sides)[3][NodeBlock::lanes], std::size_t axis) {
    const V v = hn::Load(d, sides[axis] + lane);
    return hn::Sub(hn::Sub(v, hn::Set(d, tip.high[axis])), hn::Set(d, tip.low[axis]));
  };
  return {{side(node.low, 0), side(node.low, 1), side(node.low, 2)},
          {side(node.high, 0), side(node.high, 1), side(node.high, 2)}};
}

HWY_INLINE Vector least(const Vector& a, const Vector& b) {
  return {hn::Min(a.x, b.x), hn::Min(a.y, b.y), hn::Min(a.z, b.z)};
}

HWY_INLINE Vector most(const Vector& a, const Vector& b) {
  return {hn::Max(a.x, b.x), hn::Max(a.y, b.y), hn::Max(a.z, b.z)};
}

/// What the direction proves that leads from each box to where the motion comes nearest to its
/// middle: as for triangles, by the corner that is farthest along it.
HWY_INLINE Proof proof_of_box(Float d, const Boxes& boxes, const Vector& z,
                              const FloatReach& reach) {
  const V zero = hn::Zero(d);
  const V one = hn::Set(d, 1.0f);
  const V half = hn::Set(d, 0.5f);
  const V length2 = hn::Max(dot(z, z), hn::Set(d, 1e-30f));
  const V along = hn::Mul(half, dot(boxes.low + boxes.high, z));
  const Vector p = hn::Min(hn::Max(hn::Div(along, length2), zero), one) * z;
  const Vector way = p - most(boxes.low, least(boxes.high, p));
  const V way2 = dot(way, way);
  const M is_unit = hn::And(hn::Gt(way2, hn::Set(d, 1e-30f)), hn::Lt(way2, hn::Set(d, 1e30f)));
  const Vector n = hn::Div(one, hn::Sqrt(way2)) * way;
  const Vector farthest{hn::IfThenElse(hn::Lt(n.x, zero), boxes.low.x, boxes.high.x),
                        hn::IfThenElse(hn::Lt(n.y, zero), boxes.low.y, boxes.high.y),
                        hn::IfThenElse(hn::Lt(n.z, zero), boxes.low.z, boxes.high.z)};
  const V rounding =
      hn::Mul(hn::Add(size(boxes.low), size(boxes.high)), hn::Set(d, reach.relative));
  const V clear = hn::Sub(hn::Sub(hn::Neg(dot(n, farthest)), hn::Set(d, reach.boxes)), rounding);
  return {select(is_unit, n, {zero, zero, zero}),
          hn::IfThenElse(is_unit, clear, hn::Set(d, -1e30f))};
}

void EnterBoxes(const NodeBlock& node, const FloatTip& tip, const float* motion,
                const FloatReach& reach, bool rounded, BoxEntries& entries) {
  const Float d;
  const Vector z = all(d, motion);
  const V margin = hn::Set(d, reach.boxes);
  // Where the motion stands still along an axis, a box is beside it or around it for good.
  V inverse[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    constexpr float least_motion = 1e-30f;
    const float along = motion[axis];
    const bool stands = along < least_motion && along > -least_motion;
    inverse[axis] = hn::Set(d, stands ? 1.0f / least_motion : 1.0f / along);
  }
  entries.reached = 0;
  for (std::size_t lane = 0; lane < NodeBlock::lanes; lane += hn::Lanes(d)) {
    const Boxes boxes = boxes_at(d, node, tip, lane);
    V enter = hn::Zero(d);
    V leave = hn::Set(d, 1.0f);
    const auto clip = [&](V low, V high, V per_motion) {
      const V one_end = hn::Mul(hn::Sub(low, margin), per_motion);
      const V other_end = hn::Mul(hn::Add(high, margin), per_motion);
      enter = hn::Max(enter, hn::Min(one_end, other_end));
      leave = hn::Min(leave, hn::Max(one_end, other_end));
    };
    clip(boxes.low.x, boxes.high.x, inverse[0]);
    clip(boxes.low.y, boxes.high.y, inverse[1]);
    clip(boxes.low.z, boxes.high.z, inverse[2]);
    V time = hn::Mul(enter, hn::Set(d, 0.999999f));
    M reached = hn::Le(enter, leave);
    if (rounded) {
      const Proof proof = proof_of_box(d, boxes, z, reach);
      const V along = dot(proof.n, z);
      reached = hn::AndNot(holds(d, proof, along), reached);
      time = hn::Max(time, entry(d, proof, along));
    }
    hn::Store(time, d, entries.time + lane);
    entries.reached |= bits(d, reached, lane);
  }
}

std::uint32_t BoxesNear(const NodeBlock& boxes, const FloatTip& center, float radius) {
  const Float d;
  const V zero = hn::Zero(d);
  std::uint32_t near = 0;
  for (std::size_t lane = 0; lane < NodeBlock::lanes; lane += hn::Lanes(d)) {
    const Boxes its = boxes_at(d, boxes, center, lane);
    const Vector nearest = most(its.low, least(its.high, {zero, zero, zero}));
    const V distance2 = dot(nearest, nearest);
    near |= bits(d, hn::Not(hn::Gt(distance2, hn::Set(d, radius * radius))), lane);
  }
  return near;
}

}  // namespace keepout::segment_lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <algorithm>
#include <cmath>
#include <limits>

namespace keepout {
namespace segment_lanes {

HWY_EXPORT(Look);
HWY_EXPORT(Suspect);
HWY_EXPORT(SuspectSharply);
HWY_EXPORT(EnterBoxes);
HWY_EXPORT(BoxesNear);

}  // namespace segment_lanes

FloatTip float_tip(const Vec3& tip) noexcept {
  FloatTip split;
  for (int axis = 0; axis < 3; ++axis) {
    split.high[axis] = static_cast<float>(tip[axis]);
    split.low[axis] = static_cast<float>(tip[axis] - static_cast<double>(split.high[axis]));
  }
  return split;
}

FloatReach float_reach(double margin, double longest, const Vec3& tip, double error) noexcept {
  // What the two floats of the tip leave over, and what the leaf's coordinates are off by.
  const double fixed = 1e-13 * tip.lpNorm<1>() + 4.0 * error;
  const double slack = 2e-6 * margin + 3e-6 * longest + fixed;
  const double boxes = margin * (1.0 + 2e-6) + 4e-6 * longest + fixed;
  constexpr double up = 1.0 + 1e-6;
  return {static_cast<float>(margin * up), 1.5e-6f, static_cast<float>(slack * up),
          static_cast<float>(boxes * up)};
}

void look(const LeafBlock& leaf, const FloatTip& tip, const FloatReach& reach,
          LeafScreen& screen) noexcept {
  HWY_DYNAMIC_DISPATCH(segment_lanes::Look)(leaf, tip, reach, screen);
}

void suspect(const LeafScreen& screen, const float* motion, Suspects& suspects) noexcept {
  HWY_DYNAMIC_DISPATCH(segment_lanes::Suspect)(screen, motion, suspects);
}

void suspect_sharply(const LeafBlock& leaf, const FloatTip& tip, const float* motion,
                     const FloatReach& reach, LeafScreen& screen, Suspects& suspects) noexcept {
  HWY_DYNAMIC_DISPATCH(segment_lanes::SuspectSharply)(leaf, tip, motion, reach, screen, suspects);
}

void enter_boxes(const NodeBlock& boxes, const FloatTip& tip, const float* motion,
                 const FloatReach& reach, bool rounded, BoxEntries& entries) noexcept {
  HWY_DYNAMIC_DISPATCH(segment_lanes::EnterBoxes)(boxes, tip, motion, reach, rounded, entries);
}

std::uint32_t boxes_near(const NodeBlock& boxes, const FloatTip& center, float radius) noexcept {
  return HWY_DYNAMIC_DISPATCH(segment_lanes::BoxesNear)(boxes, center, radius);
}

}  // namespace keepout

#endif
