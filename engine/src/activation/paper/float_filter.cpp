// SPDX-License-Identifier: BSD-3-Clause
//
// A floating-point filter: floats decide where their rounding allows it.
//
// The first pass over the leaves settles the triangles out of the ball, and those in it that have
// no wanted plane. It needs neither closest points nor neighbors. The second pass packs the
// remaining triangles. It finds the closest point of each, and if the neighbors share it.
//
// A point c of a triangle is its nearest to the origin if c . v >= |c|^2 for all its corners v. For
// a corner, and for a point inside a side, these are signs of polynomials in the products of the
// corners, relative to the ball's center. The same test with the apex, the third corner of the
// triangle across a side, shows if c is nearest for that triangle too.
//
// Rounding. Let u = 2^-24, S a bound of all corners and apexes, and E the error of a corner besides
// 2 u of its length. A product of two corners is off by 2 S E + 7 u S^2. A difference of two
// products is off by
//      band = S (4.2 E + 20 u S),
// and a sum of four by twice that. A number computed from these carries the bands of its terms,
// each times the size of its cofactors. Rounding in a product of two such terms is below the band
// times either. `tiny` covers products that underflow.
// either. Products that might lose digits below the least float are made up for by `tiny`.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "activation/paper/float_filter.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which sets the target to compile for.
#include <hwy/cache_control.h>

#include "../../index/tree_parts/ball_screen.h"
#include "../../lane_packing-inl.h"
#include "../../lanes-inl.h"
#include "float_filter.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::paper::HWY_NAMESPACE {
using namespace keepout::HWY_NAMESPACE;

using Unsigned = hn::RebindToUnsigned<FloatTag>;
using VU = hn::Vec<Unsigned>;

constexpr float u = 0x1p-24f;
constexpr float tiny = 1e-30f;
constexpr float overflow = 1e18f;            // of squares
constexpr float outward = 1.0f + 32.0f * u;  // more than the rounding of a length

HWY_INLINE V set(float x) { return hn::Set(FloatTag(), x); }
HWY_INLINE VU set(std::uint32_t x) { return hn::Set(Unsigned(), x); }
HWY_INLINE M none() { return hn::FirstN(FloatTag(), 0); }
HWY_INLINE M either(M a, M b) { return hn::Or(a, b); }
HWY_INLINE M both(M a, M b) { return hn::And(a, b); }
HWY_INLINE M but_not(M a, M b) { return hn::AndNot(b, a); }
HWY_INLINE bool any(M a) { return !hn::AllFalse(FloatTag(), a); }
HWY_INLINE V select(M mask, V yes, V no) { return hn::IfThenElse(mask, yes, no); }
HWY_INLINE VU flag_if(M mask, std::uint32_t flag) {
  return hn::IfThenElseZero(hn::RebindMask(Unsigned(), mask), set(flag));
}
HWY_INLINE M has(VU flags, std::uint32_t flag) {
  return hn::RebindMask(FloatTag(), hn::TestBit(flags, set(flag)));
}

/// The signs that are certain of numbers that rounding may have changed by a band.
struct Sign {
  M positive, negative;
};

HWY_INLINE Sign sign_of(V value, V band) {
  return {hn::Gt(value, band), hn::Lt(value, hn::Neg(band))};
}

/// Returns the error band of products of corners within `reach`.
HWY_INLINE V band_of(V reach, const FilterQuery& query) {
  return reach * (set(4.2f * query.error) + set(20.0f * u) * reach) + set(tiny);
}

/// Returns points of a block relative to the tip.
HWY_INLINE Vector relative(const float (&at)[3][LeafBlock::lanes], std::size_t lane,
                           const FilterQuery& query) {
  const FloatTag d;
  return load(d, at, lane) - all(d, query.high) - all(d, query.low);
}

/// The first pass over a leaf. `place`: the number of the leaf's first lane.
HWY_INLINE void look(const LeafBlock& leaf, const LeafEdges& edges, std::size_t place,
                     std::size_t lane, const FilterQuery& query, Unfinished& unfinished) {
  const FloatTag d;
  const Unsigned du;
  Vector p[3];
  V squares[3];
  for (std::size_t c = 0; c < 3; ++c) p[c] = relative(leaf.corner[c], lane, query);
  for (std::size_t c = 0; c < 3; ++c) squares[c] = dot(p[c], p[c]);
  const VU roles = hn::Load(du, edges.roles + lane);
  const V first = hn::Sqrt(squares[0]);
  const V around = hn::Load(d, edges.span + lane) + set(query.error);
  const V reach = set(outward) * (first + around);
  const V band = band_of(reach, query);
  // Beyond the ball if all corners are beyond a plane that is beyond it; in the ball if one corner
  // is.
  const V along = hn::Min(hn::Min(dot(p[0], p[1]), dot(p[0], p[2])), squares[0]);
  const M far =
      both(hn::Gt(along - band, set(query.radius * outward) * first), hn::Lt(reach, set(overflow)));
  const M near = but_not(has(roles, LeafEdges::used), far);
  if (!any(near)) return;
  const V nearest = hn::Min(hn::Min(squares[0], squares[1]), squares[2]);
  const M inside = hn::Lt(nearest + band, set(query.inside * query.inside));
  // The height of the tip above the face has the error of the corner, plus 6 u of its distance. The
  // slack allows twice these 6 u.
  const Vector normal = load(d, edges.normal, lane);
  const V above = hn::Neg(dot(normal, p[0]));
  const V slack = set(12.0f * u) * reach + set(1.1f * query.error + query.rounding + tiny);
  const V of_middle = above + dot(normal, all(d, query.middle));
  const Sign height = sign_of(above, slack);
  const M idle = hn::Gt(of_middle - slack, set(query.idle_height));
  const M faceless = either(idle, height.negative);
  const M beyond_idle = hn::Gt(first, set(outward) * (around + set(query.idle)));
  const M settled = both(both(inside, has(roles, LeafEdges::sturdy)), both(beyond_idle, faceless));
  const M left = but_not(near, settled);
  unfinished.in += hn::CountTrue(d, both(near, settled));
  if (!any(left)) return;

  const LanePacking packing(hn::RebindMask(du, left));
  const std::size_t to = unfinished.size;
  for (std::size_t c = 0; c < 3; ++c) {
    hn::StoreU(packing(p[c].x), d, unfinished.corner[c][0] + to);
    hn::StoreU(packing(p[c].y), d, unfinished.corner[c][1] + to);
    hn::StoreU(packing(p[c].z), d, unfinished.corner[c][2] + to);
  }
  const VU faces = hn::Or(flag_if(faceless, Unfinished::faceless),
                          flag_if(height.positive, Unfinished::in_front));
  const VU places = hn::Iota(du, static_cast<std::uint32_t>(place + lane));
  hn::StoreU(packing(reach), d, unfinished.reach + to);
  hn::StoreU(packing(roles), du, unfinished.roles + to);
  hn::StoreU(packing(faces), du, unfinished.plane + to);
  hn::StoreU(packing(places), du, unfinished.which + to);
  unfinished.size += packing.count();
}

/// A place where the closest point may lie: on a corner a, or inside the side from a to b.
struct Foot {
  Vector a, b;
  V aa;           // |a|^2
  V along;        // a . (b - a), negative; 0 on a corner
  V length2;      // |b - a|^2; 1 on a corner
  M inside_side;  // false on a corner, where along and length2 are exact
};

/// Returns the sign of x - along y / length2.
HWY_INLINE Sign sign_at(const Foot& foot, V x, V y, V band) {
  const V of_side = set(2.0f) * (hn::Abs(x) + hn::Abs(foot.along)) + hn::Abs(y) + set(8.0f) * band;
  const V sizes = foot.length2 + hn::IfThenElseZero(foot.inside_side, of_side);
  return sign_of(foot.length2 * x - foot.along * y, set(2.0f) * band * sizes + set(tiny));
}

/// Returns the sign of c . v - |c|^2 for the closest point c and another point v.
HWY_INLINE Sign beyond(const Foot& foot, const Vector& v, V band) {
  const V lift = dot(foot.a, v) - foot.aa;
  const V skew = dot(foot.b, v) - (foot.aa + foot.along) - lift;  // (b - a) . (v - a)
  return sign_at(foot, lift, skew, band);
}

/// Returns the sign of |c| - limit for the closest point c.
HWY_INLINE Sign over(const Foot& foot, float limit, V band) {
  return sign_at(foot, foot.aa - set(limit * limit), foot.along, band);
}

/// The closest points that floats are sure of.
struct Closest {
  M known;
  VU place;  // see `places`
  Foot foot;
};

HWY_INLINE Closest closest_of(const Vector (&p)[3], V band) {
  const V squares[3] = {dot(p[0], p[0]), dot(p[1], p[1]), dot(p[2], p[2])};
  Sign along[3][2];  // of each side, from either end
  Foot foot_of[3];   // inside each side
  M at[places];
  for (std::size_t s = 0; s < 3; ++s) {
    const auto [a, b] = corners_at[3 + s];
    const V product = dot(p[a], p[b]);
    const V from_a = product - squares[a];
    const V from_b = product - squares[b];
    along[s][0] = sign_of(from_a, band);
    along[s][1] = sign_of(from_b, band);
    foot_of[s] = {p[a], p[b], squares[a], from_a, hn::Neg(from_a + from_b), hn::Not(none())};
    at[3 + s] = both(both(along[s][0].negative, along[s][1].negative),
                     beyond(foot_of[s], p[3 - a - b], band).positive);
  }
  at[0] = both(along[0][0].positive, along[2][0].positive);
  at[1] = both(along[0][1].positive, along[1][0].positive);
  at[2] = both(along[1][1].positive, along[2][1].positive);

  const M first = either(at[1], at[4]);
  const M inside_side = either(at[3], either(at[4], at[5]));
  Closest closest{either(either(at[0], at[1]), either(at[2], inside_side)),
                  set(std::uint32_t{0}),
                  {select(first, p[1], select(at[2], p[2], p[0])), select(at[3], p[1], p[2]),
                   select(first, squares[1], select(at[2], squares[2], squares[0])),
                   hn::Zero(FloatTag()), set(1.0f), inside_side}};
  for (std::uint32_t i = 1; i < places; ++i) {
    closest.place = hn::Or(closest.place, flag_if(at[i], i));
  }
  for (std::size_t s = 0; s < 3; ++s) {
    closest.foot.along = select(at[3 + s], foot_of[s].along, closest.foot.along);
    closest.foot.length2 = select(at[3 + s], foot_of[s].length2, closest.foot.length2);
  }
  return closest;
}

/// The apexes across the sides that meet at the closest points, or across the one side that a
/// closest point is inside of. `which`: the triangles, as in Unfinished. Lanes that are not in
/// `asked` have undefined values.
struct Apexes {
  alignas(64) float of[2][3][LeafBlock::lanes] = {};  // [first or second][axis][lane]

  HWY_INLINE Apexes(VU place, M asked, std::span<const LeafEdges> edges,
                    const std::uint32_t* which) {
    alignas(64) std::uint32_t at[LeafBlock::lanes];
    hn::Store(place, Unsigned(), at);
    for (std::uint32_t rest = bits(FloatTag(), asked, 0); rest != 0; rest &= rest - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(rest));
      const auto& apex = edges[which[i] / LeafBlock::lanes].apex;
      for (std::size_t n = 0; n < 2; ++n) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          of[n][axis][i] = apex[sides_at[at[i]][n]][axis][which[i] % LeafBlock::lanes];
        }
      }
    }
  }
};

/// The second pass, over a vector of unfinished triangles from `at` on. Moves those that remain to
/// the first `kept` places, and increases `kept`.
HWY_INLINE void look_again(std::span<const LeafEdges> edges, const FilterQuery& query,
                           std::size_t at, Unfinished& unfinished, std::size_t& kept) {
  const FloatTag d;
  const Unsigned du;
  Vector p[3];
  for (std::size_t c = 0; c < 3; ++c) {
    const auto& corner = unfinished.corner[c];
    p[c] = {hn::LoadU(d, corner[0] + at), hn::LoadU(d, corner[1] + at),
            hn::LoadU(d, corner[2] + at)};
  }
  const V band = band_of(hn::LoadU(d, unfinished.reach + at), query);
  const VU roles = hn::LoadU(du, unfinished.roles + at);
  const VU faces = hn::LoadU(du, unfinished.plane + at);
  const VU which = hn::LoadU(du, unfinished.which + at);
  const M used = hn::FirstN(d, std::min(unfinished.size - at, hn::Lanes(d)));
  const Closest closest = closest_of(p, band);
  const M known = both(used, both(closest.known, has(roles, LeafEdges::sturdy)));
  const M in = both(known, both(over(closest.foot, query.inside, band).negative,
                                over(closest.foot, query.rounding, band).positive));
  const M out = both(known, over(closest.foot, query.radius, band).positive);
  const M idle = over(closest.foot, query.idle, band).positive;
  const M faceless = has(faces, Unfinished::faceless);
  const M asked = but_not(in, both(idle, faceless));
  M open = but_not(used, either(in, out));
  M second = none(), third = none();  // conditions 2 and 3 of Algorithm 1
  if (any(asked)) {
    const Apexes apexes(closest.place, asked, edges, unfinished.which + at);
    const VU its = hn::Shr(roles, hn::ShiftLeft<2>(closest.place) + closest.place);
    M shares = none(), leaves_it = none();
    for (std::size_t n = 0; n < 2; ++n) {
      const Sign apex = beyond(closest.foot, relative(apexes.of[n], 0, query), band);
      const M ridge = both(asked, has(its, LeafEdges::ridge[n]));
      const M shared = both(ridge, apex.positive);
      open = either(open, but_not(ridge, either(apex.positive, apex.negative)));
      shares = either(shares, shared);
      leaves_it = either(leaves_it, both(shared, has(its, LeafEdges::lower[n])));
    }
    second = but_not(but_not(shares, leaves_it), either(open, idle));
    third =
        both(but_not(asked, either(open, shares)), but_not(has(its, LeafEdges::valley), faceless));
    open = either(open, but_not(third, has(faces, Unfinished::in_front)));
    third = but_not(third, open);
  }
  unfinished.in += hn::CountTrue(d, but_not(in, open));
  const VU planes =
      hn::Or(flag_if(second, Unfinished::faces_tip), flag_if(third, Unfinished::of_face));
  const LanePacking packing(hn::RebindMask(du, either(open, either(second, third))));
  hn::StoreU(packing(which), du, unfinished.which + kept);
  hn::StoreU(packing(hn::Or(planes, hn::ShiftLeft<Unfinished::plane_bits>(closest.place))), du,
             unfinished.plane + kept);
  kept += packing.count();
}

/// Prefetches what the first pass reads.
HWY_INLINE void fetch(const LeafBlock& leaf, const LeafEdges& edges) {
  for (const auto& corner : leaf.corner) {
    for (const auto& axis : corner) hwy::Prefetch(axis);
  }
  for (const auto& axis : edges.normal) hwy::Prefetch(axis);
  hwy::Prefetch(edges.span);
  hwy::Prefetch(edges.roles);
}

std::size_t Filter(std::span<const LeafBlock> leaves, std::span<const LeafEdges> edges,
                   std::span<const std::uint32_t> listed, const FilterQuery& query,
                   Unfinished& unfinished) {
  constexpr std::size_t ahead = 6;  // leaves to prefetch before their pass
  unfinished.size = unfinished.in = 0;
  std::size_t i = 0;
  for (; i < listed.size() && unfinished.size + LeafBlock::lanes <= Unfinished::most; ++i) {
    const std::size_t leaf = listed[i];
    if (i + ahead < listed.size()) fetch(leaves[listed[i + ahead]], edges[listed[i + ahead]]);
    for (std::size_t lane = 0; lane < LeafBlock::lanes; lane += hn::Lanes(FloatTag())) {
      look(leaves[leaf], edges[leaf], leaf * LeafBlock::lanes, lane, query, unfinished);
    }
  }
  std::size_t kept = 0;
  for (std::size_t at = 0; at < unfinished.size; at += hn::Lanes(FloatTag())) {
    look_again(edges, query, at, unfinished, kept);
  }
  unfinished.size = kept;
  return i;
}

}  // namespace keepout::paper::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace keepout::paper {

HWY_EXPORT(Filter);

/// Runs the best version for the processor. Defined where only one target's namespace is visible.
static std::size_t filter(std::span<const LeafBlock> leaves, std::span<const LeafEdges> edges,
                          std::span<const std::uint32_t> listed, const FilterQuery& query,
                          Unfinished& unfinished) noexcept {
  return HWY_DYNAMIC_DISPATCH(Filter)(leaves, edges, listed, query, unfinished);
}

}  // namespace keepout::paper

namespace keepout {

Ball idle_ball(const Vec3& target) noexcept { return {0.5 * target, 0.51 * target.norm()}; }

FilterQuery filter_query(const RuleInput& input, const Ball& ball, const LeafFrame& frame,
                         IdlePlanes idle_planes) noexcept {
  const Vec3 tip = ball.center - frame.origin;
  const Ball idle = idle_ball(input.target);
  FilterQuery query;
  for (int axis = 0; axis < 3; ++axis) {
    query.high[axis] = static_cast<float>(tip[axis]);
    query.low[axis] = static_cast<float>(tip[axis] - static_cast<double>(query.high[axis]));
    query.middle[axis] = static_cast<float>(idle.center[axis]);
  }
  query.radius = at_least(ball.radius);
  query.inside = at_most(ball.radius);
  query.rounding = at_least(input.rounding);
  // The part of the tip beyond two floats, and the rounding of a difference as small as `low`.
  const double split = 0x1p-46 * tip.cwiseAbs().maxCoeff();
  query.error = at_least(std::sqrt(3.0) * (frame.error + split));
  query.idle_height = query.idle = std::numeric_limits<float>::infinity();
  if (idle_planes == IdlePlanes::left_out) {
    // The factor covers the rounding of the height of the middle.
    query.idle_height = at_least((idle.radius + input.clearance) * (1.0 + 0x1p-19));
    query.idle = at_least(idle.radius + idle.center.norm() + input.clearance);
  }
  return query;
}

std::size_t filter(std::span<const LeafBlock> leaves, std::span<const LeafEdges> edges,
                   std::span<const std::uint32_t> listed, const FilterQuery& query,
                   Unfinished& unfinished) noexcept {
  return paper::filter(leaves, edges, listed, query, unfinished);
}

}  // namespace keepout
#endif  // HWY_ONCE
