// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A point c of a triangle is its nearest to the origin if c . v >= |c|^2 for all its corners v. For
// a corner, and for a point inside a side, these are signs of polynomials in the products of the
// corners, relative to the ball's centre.
//
// Rounding. Let u = 2^-24, S a bound of all corners and apexes, E the error of a corner but for 2 u
// of itself. A product of two corners is off by 2 S E + 7 u S^2, the difference of two such by
//     band = S (4.2 E + 20 u S),
// sums of four by twice that. What is computed from these carries the bands of its terms, each
// times the size of its cofactors. Rounding in a product of two such terms is below the band times
// either. Products that might lose digits below the least float are made up for by `tiny`.
#if defined(KEEPOUT_CLOSEST_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KEEPOUT_CLOSEST_LANES_INL_H
#undef KEEPOUT_CLOSEST_LANES_INL_H
#else
#define KEEPOUT_CLOSEST_LANES_INL_H
#endif

#include "paper_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::paper_lanes::HWY_NAMESPACE {

/// A side from a to b, by the products of its ends.
struct Side {
  V ab;       // a . b
  V along_a;  // a . (b - a): negative if the nearest point of its line is beyond a
  V along_b;  // b . (a - b)
  V length2;  // |b - a|^2
};

HWY_INLINE Side select(M mask, const Side& yes, const Side& no) {
  return {select(mask, yes.ab, no.ab), select(mask, yes.along_a, no.along_a),
          select(mask, yes.along_b, no.along_b), select(mask, yes.length2, no.length2)};
}

HWY_INLINE Side side_of(V ab, V aa, V bb) {
  const V along_a = minus(ab, aa);
  const V along_b = minus(ab, bb);
  return {ab, along_a, along_b, hn::Neg(plus(along_a, along_b))};
}

/// (c . v - |c|^2) |b - a|^2 for the nearest point c of the side's line and another point v;
/// `lift` is a . (v - a).
HWY_INLINE Banded beyond(const Side& side, V lift, V bv, V band) {
  const V skew = minus(minus(bv, side.ab), lift);  // (b - a) . (v - a)
  const V value = minus(product(side.length2, lift), product(side.along_a, skew));
  const V sizes = plus(times(2.0f, plus(size(lift), size(side.along_a))),
                       plus(plus(size(side.length2), size(skew)), times(8.0f, band)));
  return {value, plus(times(2.0f, product(band, sizes)), hn::Set(Float(), tiny))};
}

/// (|c|^2 - limit2) |b - a|^2 for the nearest point c of the side's line.
HWY_INLINE Banded over(const Side& side, V aa, float limit2, V band) {
  const V excess = minus(aa, hn::Set(Float(), limit2));
  const V value = minus(product(excess, side.length2), product(side.along_a, side.along_a));
  const V sizes =
      plus(plus(size(excess), size(side.length2)), plus(size(side.along_a), times(8.0f, band)));
  return {value, plus(times(2.0f, product(band, sizes)), hn::Set(Float(), tiny))};
}

/// Triangles relative to the tip, and products of their corners.
struct Block {
  Vector p[3];
  V squares[3];
  Side side[3];
  V reach;  // no corner and no apex is farther from the tip
  V band;
};

HWY_INLINE V band_of(V reach, const PaperQuery& query) {
  const Float d;
  const V error = hn::Set(d, 4.2f * query.error);
  return plus(product(reach, plus(error, times(20.0f * u, reach))), hn::Set(d, tiny));
}

/// Where the closest points lie that floats are sure of, and how far away they are.
struct Closest {
  M known;
  VU place;
  M in;    // the ball, and not on the surface
  M out;   // of the ball
  M idle;  // so far away that a plane which faces the tip is
  M on_side;
  M side[3];  // on this one
  Side line;  // of that side, from a to b
};

HWY_INLINE Closest closest_corners(const Block& block, const PaperQuery& query) {
  const Float d;
  const Unsigned du;
  const auto& side = block.side;
  const V along[3][2] = {{side[0].along_a, side[2].along_a},
                         {side[0].along_b, side[1].along_a},
                         {side[1].along_b, side[2].along_b}};
  const M none = hn::FirstN(d, 0);
  Closest closest{none, hn::Zero(du), none, none, none, none, {none, none, none}, side[0]};
  V square = block.squares[0];
  for (std::size_t c = 0; c < 3; ++c) {
    const M here = both(hn::Gt(along[c][0], block.band), hn::Gt(along[c][1], block.band));
    closest.known = either(closest.known, here);
    if (c == 0) continue;
    closest.place = select(here, hn::Set(du, static_cast<std::uint32_t>(c)), closest.place);
    square = select(here, block.squares[c], square);
  }
  const V least = minus(square, block.band);
  closest.in = both(hn::Lt(plus(square, block.band), hn::Set(d, query.inside2)),
                    hn::Gt(least, hn::Set(d, query.touch2)));
  closest.out = hn::Gt(least, hn::Set(d, query.outside2));
  closest.idle = hn::Gt(least, hn::Set(d, query.idle2));
  return closest;
}

/// Of the triangles whose closest point is not known yet, those where it lies inside a side.
HWY_INLINE void add_closest_on_sides(const Block& block, const PaperQuery& query, M wanted,
                                     Closest& closest) {
  const Unsigned du;
  const auto& side = block.side;
  const V below = hn::Neg(block.band);
  M between[3];
  for (int s = 0; s < 3; ++s) {
    between[s] = both(wanted, both(hn::Lt(side[s].along_a, below), hn::Lt(side[s].along_b, below)));
  }
  if (hn::AllFalse(Float(), either(either(between[0], between[1]), between[2]))) return;

  // Of the corner opposite to each side.
  const V opposite_lift[3] = {side[2].along_a, side[0].along_b, side[0].along_a};
  const V opposite_b[3] = {side[1].ab, side[2].ab, side[1].ab};
  for (std::size_t s = 0; s < 3; ++s) {
    const M here =
        both(between[s], is_positive(beyond(side[s], opposite_lift[s], opposite_b[s], block.band)));
    closest.side[s] = here;
    closest.on_side = either(closest.on_side, here);
    closest.place = select(here, hn::Set(du, static_cast<std::uint32_t>(3 + s)), closest.place);
    if (s > 0) closest.line = select(here, side[s], closest.line);
  }
  const V aa = select(closest.side[1], block.squares[1], block.squares[0]);
  const auto is_over = [&](float limit2) {
    return both(closest.on_side, is_positive(over(closest.line, aa, limit2, block.band)));
  };
  const M under = is_negative(over(closest.line, aa, query.inside2, block.band));
  closest.known = either(closest.known, closest.on_side);
  closest.in = either(but_not(closest.in, closest.on_side), both(under, is_over(query.touch2)));
  closest.out = either(but_not(closest.out, closest.on_side), is_over(query.outside2));
  closest.idle = either(but_not(closest.idle, closest.on_side), is_over(query.idle2));
}

/// Whether the triangle across the first side that meets at the closest point, or the second, has
/// the same closest point: where positive; another one where negative.
struct Shared {
  Banded first, second;
};

HWY_INLINE Shared shared_points(const Vector (&apex)[3], const Block& block,
                                const Closest& closest) {
  const Float d;
  const Unsigned du;
  const V band = block.band;
  V lift[3][2];  // a . (apex - a) for the apex across each side and the ends a of the side
  for (std::size_t s = 0; s < 3; ++s) {
    for (std::size_t end = 0; end < 2; ++end) {
      const auto a = static_cast<std::size_t>(sides[s][end]);
      lift[s][end] = minus(dot(apex[s], block.p[a]), block.squares[a]);
    }
  }
  // In the order of sides_at.
  const V first[3] = {lift[0][0], lift[0][1], lift[1][1]};
  const V second[3] = {lift[2][0], lift[1][0], lift[2][1]};
  Shared shared{{first[0], band}, {second[0], band}};
  for (std::uint32_t c = 1; c < 3; ++c) {
    const M here = hn::RebindMask(d, hn::Eq(closest.place, hn::Set(du, c)));
    shared.first.value = select(here, first[c], shared.first.value);
    shared.second.value = select(here, second[c], shared.second.value);
  }
  if (hn::AllFalse(d, closest.on_side)) return shared;
  V apex_lift = lift[0][0];
  V apex_b = plus(lift[0][1], block.squares[1]);
  for (std::size_t s = 1; s < 3; ++s) {
    apex_lift = select(closest.side[s], lift[s][0], apex_lift);
    apex_b = select(closest.side[s], plus(lift[s][1], block.squares[2]), apex_b);
  }
  shared.first =
      select(closest.on_side, beyond(closest.line, apex_lift, apex_b, band), shared.first);
  return shared;
}

}  // namespace keepout::paper_lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
