// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "activation/paper_screen.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

#include <algorithm>

#include "closest_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::paper_lanes::HWY_NAMESPACE {

/// What follows from where the closest point lies.
struct Decided {
  M faces;  // condition 2
  M front;  // condition 3
  M open;   // floats cannot tell
};

/// Algorithm 1 from condition 2 on, of triangles whose closest point is known.
HWY_INLINE Decided decide(VU roles, M known, const Shared& shared, M in_front, M behind) {
  const M first_ridge = has(roles, LeafEdges::first_ridge);
  const M second_ridge = has(roles, LeafEdges::second_ridge);
  const M first_shares = both(first_ridge, is_positive(shared.first));
  const M second_shares = both(second_ridge, is_positive(shared.second));
  const M first_open = but_not(but_not(first_ridge, first_shares), is_negative(shared.first));
  const M second_open = but_not(but_not(second_ridge, second_shares), is_negative(shared.second));
  const M open = both(known, either(first_open, second_open));
  const M told = but_not(known, open);
  const M shares = either(first_shares, second_shares);
  const M leaves_it = either(both(first_shares, has(roles, LeafEdges::first_lower)),
                             both(second_shares, has(roles, LeafEdges::second_lower)));
  const M third = both(but_not(told, shares), has(roles, LeafEdges::valley));
  const M front = both(third, in_front);
  const M on_plane = but_not(but_not(third, front), behind);
  return {both(told, but_not(shares, leaves_it)), front, either(open, on_plane)};
}

/// The apexes across a side.
HWY_INLINE Vector apexes(std::span<const LeafEdges> edges, const PaperRest& rest, std::size_t at,
                         M asked, std::size_t side, const PaperQuery& query) {
  const Float d;
  alignas(64) float apex[3][LeafBlock::lanes] = {};
  const std::size_t count = hn::Lanes(d);
  const std::uint32_t wanted = bits(asked, 0);
  for (std::size_t i = 0; i < count; ++i) {
    // Of one that is not asked for, any will do.
    const std::uint32_t place = rest.place[((wanted >> i) & 1u) != 0 ? at + i : at];
    const LeafEdges& leaf = edges[place / LeafBlock::lanes];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      apex[axis][i] = leaf.apex[side][axis][place % LeafBlock::lanes];
    }
  }
  return points(apex, 0, query);
}

void ScreenLanes(std::span<const LeafEdges> edges, const PaperQuery& query, const PaperRest& rest,
                 std::size_t at, PaperAnswers& answers) {
  const Float d;
  const Unsigned du;
  Block block;
  for (std::size_t c = 0; c < 3; ++c) {
    block.p[c] = {hn::LoadU(d, rest.corner[c][0] + at), hn::LoadU(d, rest.corner[c][1] + at),
                  hn::LoadU(d, rest.corner[c][2] + at)};
    block.squares[c] = dot(block.p[c], block.p[c]);
  }
  block.reach = hn::LoadU(d, rest.reach + at);
  const V error = times(4.2f, hn::Set(d, query.error));
  block.band =
      plus(product(block.reach, plus(error, times(20.0f * u, block.reach))), hn::Set(d, tiny));
  for (std::size_t s = 0; s < 3; ++s) {
    const auto [a, b] = sides[s];
    block.side[s] = side_of(dot(block.p[a], block.p[b]), block.squares[a], block.squares[b]);
  }
  const VU flags = hn::LoadU(du, rest.corners + at);
  const M used = hn::FirstN(d, std::min(rest.size - at, hn::Lanes(d)));
  Closest closest = closest_corners(block, query);
  add_closest_on_sides(block, query, but_not(used, closest.known), closest);
  const M known = both(used, both(closest.known, has(flags, LeafEdges::sturdy)));
  const M known_in = both(known, closest.in);
  const M unknown = but_not(but_not(used, known_in), both(known, closest.out));
  const M face_is_idle = has(flags, PaperRest::face_is_idle);
  const M faceless = either(face_is_idle, has(flags, PaperRest::behind));
  const M planeless = either(has(flags, PaperRest::planeless), both(closest.idle, faceless));
  const M asked = but_not(known_in, planeless);
  const VU number = hn::AndNot(hn::Set(du, LeafBlock::odd), hn::LoadU(du, rest.source + at));
  M open = unknown;
  if (!hn::AllFalse(d, asked)) {
    const VU roles = hn::Shr(hn::LoadU(du, rest.roles + at),
                             hn::Add(hn::ShiftLeft<2>(closest.place), closest.place));
    const Vector apex[3] = {apexes(edges, rest, at, asked, 0, query),
                            apexes(edges, rest, at, asked, 1, query),
                            apexes(edges, rest, at, asked, 2, query)};
    const Shared shared = shared_points(apex, block, closest);
    const Decided decided = decide(roles, asked, shared, has(flags, PaperRest::in_front),
                                   has(flags, PaperRest::behind));
    open = either(open, decided.open);
    // Planes that are needed go to the list.
    const M planes =
        either(but_not(decided.faces, closest.idle), but_not(decided.front, face_is_idle));
    const VU corners = hn::And(hn::Shr(flags, hn::ShiftLeft<2>(closest.place)), hn::Set(du, 15));
    const LanePacking packed = packing_of(planes);
    append(number, packed, answers.triangle + answers.planes);
    append(hn::Or(corners, flag_if(decided.faces, PaperAnswers::faces_tip)), packed,
           answers.origin + answers.planes);
    answers.planes += packed.count();
  }
  answers.in += hn::CountTrue(d, but_not(known_in, open));
  const LanePacking opens = packing_of(open);
  append(number, opens, answers.open + answers.opens);
  answers.opens += opens.count();
}

void Screen(std::span<const LeafEdges> edges, const PaperQuery& query, const PaperRest& rest,
            PaperAnswers& answers) {
  answers.in = rest.settled;
  answers.planes = answers.opens = 0;
  for (std::size_t at = 0; at < rest.size; at += hn::Lanes(Float())) {
    ScreenLanes(edges, query, rest, at, answers);
  }
}

}  // namespace keepout::paper_lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace keepout::paper_lanes {

HWY_EXPORT(Screen);

}  // namespace keepout::paper_lanes

namespace keepout {

void screen(std::span<const LeafEdges> edges, const PaperQuery& query, const PaperRest& rest,
            PaperAnswers& answers) noexcept {
  using namespace paper_lanes;
  HWY_DYNAMIC_DISPATCH(Screen)(edges, query, rest, answers);
}

}  // namespace keepout
#endif  // HWY_ONCE
