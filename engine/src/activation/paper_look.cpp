// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "activation/paper_look.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "closest_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::paper_lanes::HWY_NAMESPACE {

constexpr std::size_t ahead = 6;  // so many leaves is memory ahead of the look at them

/// The face, as the tip sees it.
struct Face {
  Banded above;  // how high the tip is above it [length]
  M idle;        // its plane is
};

HWY_INLINE Face face_of(const Block& block, const LeafEdges& edges, std::size_t lane,
                        const PaperQuery& query) {
  const Float d;
  const Vector normal{hn::Load(d, edges.normal[0] + lane), hn::Load(d, edges.normal[1] + lane),
                      hn::Load(d, edges.normal[2] + lane)};
  const Vector middle{hn::Set(d, query.middle[0]), hn::Set(d, query.middle[1]),
                      hn::Set(d, query.middle[2])};
  const V above = hn::Neg(dot(normal, block.p[0]));
  // Off by the error of the corner, and by 6 u of its distance; as much again for good measure.
  const V farthest = plus(block.reach, hn::Set(d, query.middle_length));
  const V band =
      plus(times(12.0f * u, farthest), hn::Set(d, 1.1f * query.error + query.rounding + tiny));
  const V above_middle = minus(plus(above, dot(normal, middle)), band);
  return {{above, band}, hn::Gt(above_middle, hn::Set(d, query.idle_height))};
}

/// Asks the memory for what a first look reads.
HWY_INLINE void fetch(const LeafBlock& leaf, const LeafEdges& edges) {
  for (const auto& corner : leaf.corner) {
    for (const auto& axis : corner) hwy::Prefetch(axis);
  }
  for (const auto& axis : edges.normal) hwy::Prefetch(axis);
  hwy::Prefetch(edges.span);
  hwy::Prefetch(edges.corners);
}

HWY_INLINE void LookAtLanes(const LeafBlock& leaf, const LeafEdges& edges, std::uint32_t number,
                            std::size_t lane, const PaperQuery& query, PaperRest& rest) {
  const Float d;
  const Unsigned du;
  Block block;
  for (int c = 0; c < 3; ++c) block.p[c] = points(leaf.corner[c], lane, query);
  const VU flags = hn::Load(du, edges.corners + lane);
  for (int c = 0; c < 3; ++c) block.squares[c] = dot(block.p[c], block.p[c]);
  const V first = hn::Sqrt(block.squares[0]);
  const V around = plus(hn::Load(d, edges.span + lane), hn::Set(d, query.error));
  const auto is_beyond = [&](float distance) {
    return hn::Gt(first, times(outward, plus(around, hn::Set(d, distance))));
  };
  block.reach = times(outward, plus(first, around));
  block.band = band_of(block.reach, query);
  // Beyond the ball if all corners are beyond a plane that is; in it if one corner is.
  const V along =
      hn::Min(hn::Min(dot(block.p[0], block.p[1]), dot(block.p[0], block.p[2])), block.squares[0]);
  const V limit = times(query.radius * outward, first);
  const M far =
      both(hn::Gt(minus(along, block.band), limit), hn::Lt(block.reach, hn::Set(d, overflow)));
  const M near = but_not(has(flags, LeafEdges::used), far);
  if (hn::AllFalse(d, near)) return;
  const V nearest = hn::Min(hn::Min(block.squares[0], block.squares[1]), block.squares[2]);
  const M inside = hn::Lt(plus(nearest, block.band), hn::Set(d, query.inside2));
  const Face face = face_of(block, edges, lane, query);
  const M behind = is_negative(face.above);
  const M faceless = both(has(flags, LeafEdges::sturdy), either(face.idle, behind));
  const M planeless = both(is_beyond(query.idle), faceless);
  const M settled = both(near, both(inside, planeless));
  rest.settled += hn::CountTrue(d, settled);

  const M unsettled = but_not(near, settled);
  if (hn::AllFalse(d, unsettled)) return;
  const LanePacking chosen = packing_of(unsettled);
  const std::size_t to = rest.size;
  for (std::size_t c = 0; c < 3; ++c) {
    append(block.p[c].x, chosen, rest.corner[c][0] + to);
    append(block.p[c].y, chosen, rest.corner[c][1] + to);
    append(block.p[c].z, chosen, rest.corner[c][2] + to);
  }
  append(block.reach, chosen, rest.reach + to);
  const VU known =
      hn::Or(hn::Or(flag_if(face.idle, PaperRest::face_is_idle),
                    flag_if(is_positive(face.above), PaperRest::in_front)),
             hn::Or(flag_if(behind, PaperRest::behind), flag_if(planeless, PaperRest::planeless)));
  append(hn::Or(flags, known), chosen, rest.corners + to);
  append(hn::Load(du, edges.roles + lane), chosen, rest.roles + to);
  append(hn::Load(du, leaf.source + lane), chosen, rest.source + to);
  const auto place = static_cast<std::uint32_t>(number * LeafBlock::lanes + lane);
  append(hn::Iota(du, place), chosen, rest.place + to);
  rest.size += chosen.count();
}

std::size_t Look(const WideBvh& tree, std::span<const LeafEdges> edges, const PaperQuery& query,
                 std::span<const std::uint32_t> leaves, PaperRest& rest) {
  rest.size = rest.settled = 0;
  std::size_t i = 0;
  for (; i < leaves.size() && rest.size + LeafBlock::lanes <= PaperRest::most; ++i) {
    const std::uint32_t number = leaves[i];
    if (i + ahead < leaves.size())
      fetch(tree.leaves()[leaves[i + ahead]], edges[leaves[i + ahead]]);
    for (std::size_t lane = 0; lane < LeafBlock::lanes; lane += hn::Lanes(Float())) {
      LookAtLanes(tree.leaves()[number], edges[number], number, lane, query, rest);
    }
  }
  return i;
}

std::uint32_t BoxesNear(const NodeBlock& boxes, const PaperQuery& query) {
  const Float d;
  // Differences are off by 3 u of themselves, and by the error.
  const V radius = times(1.0f + 32.0f * u, hn::Set(d, query.radius + query.error));
  std::uint32_t near = 0;
  for (std::size_t lane = 0; lane < NodeBlock::lanes; lane += hn::Lanes(d)) {
    V distance2 = hn::Zero(d);
    for (int axis = 0; axis < 3; ++axis) {
      const V high = hn::Set(d, query.high[axis]);
      const V low = hn::Set(d, query.low[axis]);
      const V below = minus(minus(hn::Load(d, boxes.low[axis] + lane), high), low);
      const V above = plus(minus(high, hn::Load(d, boxes.high[axis] + lane)), low);
      const V off = hn::Max(hn::Max(below, above), hn::Zero(d));
      distance2 = plus(distance2, product(off, off));
    }
    const M beyond_ball = hn::Gt(distance2, plus(product(radius, radius), hn::Set(d, tiny)));
    const hn::RebindToUnsigned<Float> d32;
    const M used = hn::RebindMask(d, hn::Ne(hn::Load(d32, boxes.child + lane), hn::Zero(d32)));
    near |= bits(hn::AndNot(beyond_ball, used), lane);
  }
  return near;
}

}  // namespace keepout::paper_lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace keepout::paper_lanes {

HWY_EXPORT(Look);
HWY_EXPORT(BoxesNear);

}  // namespace keepout::paper_lanes

namespace keepout {

std::size_t look(const WideBvh& tree, std::span<const LeafEdges> edges, const PaperQuery& query,
                 std::span<const std::uint32_t> leaves, PaperRest& rest) noexcept {
  using namespace paper_lanes;
  return HWY_DYNAMIC_DISPATCH(Look)(tree, edges, query, leaves, rest);
}

std::uint32_t boxes_near(const NodeBlock& boxes, const PaperQuery& query) noexcept {
  using namespace paper_lanes;
  return HWY_DYNAMIC_DISPATCH(BoxesNear)(boxes, query);
}

}  // namespace keepout
#endif  // HWY_ONCE
