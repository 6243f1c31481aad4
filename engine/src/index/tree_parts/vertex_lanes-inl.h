// SPDX-License-Identifier: BSD-3-Clause
//
// Vertices of a mesh in the lanes of registers, and their order. Included once for each SIMD
// target: see foreach_target.h of Highway.
#if defined(KEEPOUT_VERTEX_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KEEPOUT_VERTEX_LANES_INL_H
#undef KEEPOUT_VERTEX_LANES_INL_H
#else
#define KEEPOUT_VERTEX_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>

#include "keepout/geometry/shapes.h"
#include "triangle_blocks.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class Number>
using Lanes = hn::CappedTag<Number, LeafBlock::lanes>;

template <class Number>
struct Place {
  hn::Vec<Lanes<Number>> x, y, z;
};

template <class Number>
using Choice = hn::Mask<Lanes<Number>>;

template <class Number>
HWY_INLINE Choice<Number> is_before(const Place<Number>& a, const Place<Number>& b) {
  const auto in_plane = hn::Or(hn::Lt(a.y, b.y), hn::And(hn::Eq(a.y, b.y), hn::Lt(a.z, b.z)));
  return hn::Or(hn::Lt(a.x, b.x), hn::And(hn::Eq(a.x, b.x), in_plane));
}

template <class Number>
HWY_INLINE Place<Number> choose(Choice<Number> first, const Place<Number>& a,
                                const Place<Number>& b) {
  return {hn::IfThenElse(first, a.x, b.x), hn::IfThenElse(first, a.y, b.y),
          hn::IfThenElse(first, a.z, b.z)};
}

HWY_INLINE void store(const Place<float>& place, const Vec3&, float (&corner)[3][LeafBlock::lanes],
                      std::size_t first) {
  const Lanes<float> d;
  hn::Store(place.x, d, corner[0] + first);
  hn::Store(place.y, d, corner[1] + first);
  hn::Store(place.z, d, corner[2] + first);
}

HWY_INLINE void store(const Place<double>& place, const Vec3& origin,
                      float (&corner)[3][LeafBlock::lanes], std::size_t first) {
  const Lanes<double> d;
  const hn::Rebind<float, Lanes<double>> floats;
  const auto write = [&](hn::Vec<Lanes<double>> x, int axis) HWY_ATTR {
    const auto from_origin = hn::Sub(x, hn::Set(d, origin[axis]));
    hn::Store(hn::DemoteTo(floats, from_origin), floats, corner[axis] + first);
  };
  write(place.x, 0);
  write(place.y, 1);
  write(place.z, 2);
}

#if HWY_TARGET != HWY_SCALAR
/// Returns two coordinates, from `axis` on, of every second of the vertices from `lane` on.
template <std::size_t Count, class VertexOf>
HWY_INLINE auto every_second(const VertexOf& vertex_of, std::size_t lane, std::size_t axis) {
  const hn::CappedTag<double, Count> d;
  if constexpr (Count == 2) {
    return hn::LoadU(d, vertex_of(lane).data() + axis);
  } else {
    const auto low = every_second<Count / 2>(vertex_of, lane, axis);
    const auto high = every_second<Count / 2>(vertex_of, lane + Count / 2, axis);
    return hn::Combine(d, high, low);
  }
}

/// Reads a vertex for each lane: vertex_of(lane). Vertices are read one after the other, and their
/// coordinates are separated in registers.
template <class VertexOf>
HWY_INLINE void read(const VertexOf& vertex_of, Place<double>& place) {
  const Lanes<double> d;
  constexpr std::size_t lanes = hn::MaxLanes(Lanes<double>());
  const auto even = every_second<lanes>(vertex_of, 0, 0);
  const auto odd = every_second<lanes>(vertex_of, 1, 0);
  place.x = hn::InterleaveLower(d, even, odd);
  place.y = hn::InterleaveUpper(d, even, odd);
  place.z = hn::InterleaveUpper(d, every_second<lanes>(vertex_of, 0, 1),
                                every_second<lanes>(vertex_of, 1, 1));
}

using Four = hn::CappedTag<float, 4>;

/// Returns a vertex relative to the origin, rounded to floats, and one unused number.
template <class Doubles>
HWY_INLINE hn::Vec<Four> rounded(Doubles d, const Vec3& vertex, const Vec3& origin) {
  if constexpr (hn::MaxLanes(Doubles()) == 4) {
    // Both may be at the end of the memory.
    const auto three = hn::FirstN(d, 3);
    return hn::DemoteTo(Four(), hn::Sub(hn::MaskedLoad(three, d, vertex.data()),
                                        hn::MaskedLoad(three, d, origin.data())));
  } else {
    const hn::Half<Four> half;
    const auto xy = hn::Sub(hn::LoadU(d, vertex.data()), hn::LoadU(d, origin.data()));
    const auto z = hn::Set(d, vertex.z() - origin.z());
    return hn::Combine(Four(), hn::DemoteTo(half, z), hn::DemoteTo(half, xy));
  }
}

/// Returns every fourth of the vertices from `lane` on, side by side.
template <std::size_t Count, class VertexOf>
HWY_INLINE auto every_fourth(const VertexOf& vertex_of, const Vec3& origin, std::size_t lane) {
  if constexpr (Count == 4) {
    return rounded(hn::CappedTag<double, 4>(), vertex_of(lane), origin);
  } else {
    const auto low = every_fourth<Count / 2>(vertex_of, origin, lane);
    const auto high = every_fourth<Count / 2>(vertex_of, origin, lane + Count / 2);
    return hn::Combine(hn::CappedTag<float, Count>(), high, low);
  }
}

/// Like read(vertex_of, place), but subtracts the origin and rounds to floats.
template <class VertexOf>
HWY_INLINE void read(const VertexOf& vertex_of, const Vec3& origin, Place<float>& place) {
  const Lanes<float> d;
  const hn::RepartitionToWide<Lanes<float>> pairs;
  constexpr std::size_t lanes = hn::MaxLanes(Lanes<float>());
  const auto first = every_fourth<lanes>(vertex_of, origin, 0);
  const auto second = every_fourth<lanes>(vertex_of, origin, 1);
  const auto third = every_fourth<lanes>(vertex_of, origin, 2);
  const auto fourth = every_fourth<lanes>(vertex_of, origin, 3);
  const auto xy_front = hn::BitCast(pairs, hn::InterleaveLower(d, first, second));
  const auto xy_back = hn::BitCast(pairs, hn::InterleaveLower(d, third, fourth));
  const auto z_front = hn::BitCast(pairs, hn::InterleaveUpper(d, first, second));
  const auto z_back = hn::BitCast(pairs, hn::InterleaveUpper(d, third, fourth));
  place.x = hn::BitCast(d, hn::InterleaveLower(pairs, xy_front, xy_back));
  place.y = hn::BitCast(d, hn::InterleaveUpper(pairs, xy_front, xy_back));
  place.z = hn::BitCast(d, hn::InterleaveLower(pairs, z_front, z_back));
}
#else
template <class VertexOf>
HWY_INLINE void read(const VertexOf& vertex_of, Place<double>& place) {
  const Vec3& from = vertex_of(0);
  const Lanes<double> d;
  place = {hn::Set(d, from.x()), hn::Set(d, from.y()), hn::Set(d, from.z())};
}

template <class VertexOf>
HWY_INLINE void read(const VertexOf& vertex_of, const Vec3& origin, Place<float>& place) {
  const Vec3 from = vertex_of(0) - origin;
  const Lanes<float> d;
  place = {hn::Set(d, static_cast<float>(from.x())), hn::Set(d, static_cast<float>(from.y())),
           hn::Set(d, static_cast<float>(from.z()))};
}
#endif

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // include guard, one for each target
