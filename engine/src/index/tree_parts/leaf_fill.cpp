// SPDX-License-Identifier: BSD-3-Clause
#include "leaf_fill.h"

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "../../parallel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "index/tree_parts/leaf_fill.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which sets the target to compile for.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

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

/// Reads corner `c` of the triangles from lane `first` on. The vertices are read one after the
/// other, and their coordinates are separated afterwards.
HWY_INLINE void read(const Vec3* vertices, const Corners* triangles, std::size_t c,
                     Place<double>& place) {
  const Lanes<double> d;
  constexpr std::size_t lanes = hn::MaxLanes(Lanes<double>());
  HWY_ALIGN double gathered[lanes][4];
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const Vec3& from = vertices[triangles[lane][c]];
    gathered[lane][0] = from.x();
    gathered[lane][1] = from.y();
    gathered[lane][2] = from.z();
    gathered[lane][3] = 0.0;
  }
  hn::Vec<Lanes<double>> unused;
  hn::LoadInterleaved4(d, gathered[0], place.x, place.y, place.z, unused);
}

#if HWY_TARGET != HWY_SCALAR
using Four = hn::CappedTag<float, 4>;

/// Returns a vertex whose coordinates are floats, and one unused number.
template <class Doubles>
HWY_INLINE hn::Vec<Four> rounded(Doubles d, const Vec3& vertex) {
  if constexpr (hn::MaxLanes(Doubles()) == 4) {
    // The vertex may be at the end of the memory.
    return hn::DemoteTo(Four(), hn::MaskedLoad(hn::FirstN(d, 3), d, vertex.data()));
  } else {
    const hn::Half<Four> half;
    return hn::Combine(Four(), hn::DemoteTo(half, hn::Set(d, vertex.z())),
                       hn::DemoteTo(half, hn::LoadU(d, vertex.data())));
  }
}

/// Returns every fourth of the vertices from lane `lane` on, side by side.
template <std::size_t Lanes>
HWY_INLINE auto every_fourth(const Vec3* vertices, const Corners* triangles, std::size_t c,
                             std::size_t lane) {
  if constexpr (Lanes == 4) {
    return rounded(hn::CappedTag<double, 4>(), vertices[triangles[lane][c]]);
  } else {
    const auto low = every_fourth<Lanes / 2>(vertices, triangles, c, lane);
    const auto high = every_fourth<Lanes / 2>(vertices, triangles, c, lane + Lanes / 2);
    return hn::Combine(hn::CappedTag<float, Lanes>(), high, low);
  }
}

HWY_INLINE void read(const Vec3* vertices, const Corners* triangles, std::size_t c,
                     Place<float>& place) {
  const Lanes<float> d;
  const hn::RepartitionToWide<Lanes<float>> pairs;
  constexpr std::size_t lanes = hn::MaxLanes(Lanes<float>());
  const auto first = every_fourth<lanes>(vertices, triangles, c, 0);
  const auto second = every_fourth<lanes>(vertices, triangles, c, 1);
  const auto third = every_fourth<lanes>(vertices, triangles, c, 2);
  const auto fourth = every_fourth<lanes>(vertices, triangles, c, 3);
  const auto xy_front = hn::BitCast(pairs, hn::InterleaveLower(d, first, second));
  const auto xy_back = hn::BitCast(pairs, hn::InterleaveLower(d, third, fourth));
  const auto z_front = hn::BitCast(pairs, hn::InterleaveUpper(d, first, second));
  const auto z_back = hn::BitCast(pairs, hn::InterleaveUpper(d, third, fourth));
  place.x = hn::BitCast(d, hn::InterleaveLower(pairs, xy_front, xy_back));
  place.y = hn::BitCast(d, hn::InterleaveUpper(pairs, xy_front, xy_back));
  place.z = hn::BitCast(d, hn::InterleaveLower(pairs, z_front, z_back));
}
#else
HWY_INLINE void read(const Vec3* vertices, const Corners* triangles, std::size_t c,
                     Place<float>& place) {
  const Vec3& from = vertices[(*triangles)[c]];
  const Lanes<float> d;
  place = {hn::Set(d, static_cast<float>(from.x())), hn::Set(d, static_cast<float>(from.y())),
           hn::Set(d, static_cast<float>(from.z()))};
}
#endif

/// Writes the corners in lexicographic order; equal corners keep their order, as in corner_order().
/// Corners are ordered before the origin is subtracted, because rounding could make different
/// corners equal.
template <class Number>
HWY_INLINE void fill_leaf(const Vec3* vertices, const Corners* triangles, const Vec3& origin,
                          LeafBlock& leaf) {
  const Lanes<Number> d;
  std::uint32_t odd = 0;
  for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(d)) {
    Place<Number> a, b, c;
    read(vertices, triangles + first, 0, a);
    read(vertices, triangles + first, 1, b);
    read(vertices, triangles + first, 2, c);
    const Choice<Number> b_before_a = is_before<Number>(b, a);
    const Choice<Number> c_before_a = is_before<Number>(c, a);
    const Choice<Number> c_before_b = is_before<Number>(c, b);
    const Place<Number> lower = choose<Number>(b_before_a, b, a);
    const Place<Number> upper = choose<Number>(b_before_a, a, b);
    const Choice<Number> c_is_first =
        hn::Or(hn::And(b_before_a, c_before_b), hn::AndNot(b_before_a, c_before_a));
    const Choice<Number> c_is_not_last =
        hn::Or(hn::And(b_before_a, c_before_a), hn::AndNot(b_before_a, c_before_b));
    store(choose<Number>(c_is_first, c, lower), origin, leaf.corner[0], first);
    store(choose<Number>(c_is_first, lower, choose<Number>(c_is_not_last, c, upper)), origin,
          leaf.corner[1], first);
    store(choose<Number>(c_is_not_last, upper, c), origin, leaf.corner[2], first);

    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::Xor(hn::Xor(b_before_a, c_before_a), c_before_b), bits);
    odd |= (bits[0] | std::uint32_t{bits[1]} << 8) << first;
  }
  const hn::CappedTag<std::uint32_t, LeafBlock::lanes> tags;
  const auto odd_bit = hn::Set(tags, LeafBlock::odd);
  for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(tags)) {
    const auto named = hn::Load(tags, leaf.tagged_triangle + first);
    const auto places = hn::Sub(hn::Set(tags, 31), hn::Iota(tags, static_cast<std::uint32_t>(first)));
    const auto parity = hn::And(hn::Shl(hn::Set(tags, odd), places), odd_bit);
    const auto is_unused = hn::Eq(named, hn::Set(tags, no_triangle));
    hn::Store(hn::IfThenElse(is_unused, named, hn::Or(hn::AndNot(odd_bit, named), parity)), tags,
              leaf.tagged_triangle + first);
  }
}

HWY_INLINE bool is_full(const LeafBlock& leaf) { return leaf.is_used(LeafBlock::lanes - 1); }

/// Without prefetching, the processor would wait for nearly every read. So the triangle numbers of
/// a leaf are fetched many leaves ahead, then its triangles, then its vertices.
template <class Number>
HWY_INLINE void fill_leaves(const Mesh& mesh, const LeafCorners* corners, const Vec3& origin,
                            std::span<LeafBlock> leaves, std::size_t first, std::size_t last) {
  constexpr std::size_t vertices_ahead = 4;
  constexpr std::size_t triangles_ahead = 12;
  constexpr std::size_t sources_ahead = 24;
  const Corners* triangles = mesh.triangles().data();
  const Vec3* vertices = mesh.vertices().data();
  LeafCorners looked_up[vertices_ahead];
  if (corners == nullptr) {
    // The previous call has fetched these.
    for (std::size_t i = first; i < std::min(first + vertices_ahead, leaves.size()); ++i) {
      look_up(triangles, leaves[i], looked_up[i % vertices_ahead]);
    }
  }
  for (std::size_t i = first; i < last; ++i) {
    LeafCorners& spare = looked_up[i % vertices_ahead];
    fill_leaf<Number>(vertices, corners == nullptr ? spare.data() : corners[i].data(), origin,
                      leaves[i]);
    if (i + sources_ahead < leaves.size()) hwy::Prefetch(leaves[i + sources_ahead].tagged_triangle);
    if (corners == nullptr && i + triangles_ahead < leaves.size() &&
        is_full(leaves[i + triangles_ahead])) {
      const LeafBlock& ahead = leaves[i + triangles_ahead];
      for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
        hwy::Prefetch(&triangles[ahead.triangle(lane)]);
      }
    }
    if (i + vertices_ahead < leaves.size()) {
      LeafBlock& ahead = leaves[i + vertices_ahead];
      if (corners == nullptr) look_up(triangles, ahead, spare);
      for (const Corners& triangle : corners == nullptr ? spare : corners[i + vertices_ahead]) {
        for (const VertexId v : triangle) hwy::Prefetch(&vertices[v]);
      }
      for (auto& corner : ahead.corner) {
        for (const auto& coordinates : corner) __builtin_prefetch(coordinates, 1);  // to be written
      }
    }
  }
}

void FillFromFloats(const Mesh& mesh, const LeafCorners* corners, std::span<LeafBlock> leaves,
                    std::size_t first, std::size_t last) {
  fill_leaves<float>(mesh, corners, Vec3::Zero(), leaves, first, last);
}

void FillFromDoubles(const Mesh& mesh, const LeafCorners* corners, const Vec3& origin,
                     std::span<LeafBlock> leaves, std::size_t first, std::size_t last) {
  fill_leaves<double>(mesh, corners, origin, leaves, first, last);
}

/// Returns true if all numbers are floats.
bool AreFloats(std::span<const double> numbers) {
  const hn::CappedTag<double, 8> d;
  const hn::Rebind<float, decltype(d)> floats;
  const auto is_off = [&](hn::Vec<decltype(d)> exact) HWY_ATTR {
    return hn::Ne(exact, hn::PromoteTo(d, hn::DemoteTo(floats, exact)));
  };
  auto off = hn::FirstN(d, 0);
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= numbers.size(); i += hn::Lanes(d)) {
    off = hn::Or(off, is_off(hn::LoadU(d, &numbers[i])));
  }
  for (; i < numbers.size(); ++i) off = hn::Or(off, is_off(hn::Set(d, numbers[i])));
  return hn::AllFalse(d, off);
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(FillFromFloats);
HWY_EXPORT(FillFromDoubles);
HWY_EXPORT(AreFloats);

LeafFill::LeafFill(const Mesh& mesh, unsigned threads) : mesh_(mesh) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  std::atomic<bool> are_floats = true;
  share_ranges(mesh.vertex_count(), threads, [&](std::size_t begin, std::size_t end) {
    if (!are_floats) return;
    const std::span numbers(mesh.vertices()[begin].data(), 3 * (end - begin));
    if (!HWY_DYNAMIC_DISPATCH(AreFloats)(numbers)) are_floats = false;
  });
  if (are_floats) return;
  // Corners that round to the same floats may still have an order, so the doubles are used.
  const Box& bounds = mesh.bounds();
  frame_.origin = bounds.center();
  // Half of a float's last digit, and of a double's for the subtraction of the origin. Below the
  // normal range of floats the last digit keeps its size.
  const double farthest =
      std::max((bounds.high - frame_.origin).maxCoeff(), (frame_.origin - bounds.low).maxCoeff());
  frame_.error = 0x1p-24 * (1.0 + 0x1p-20) * farthest + 0x1p-149;
}

void LeafFill::fill(std::span<LeafBlock> leaves, std::size_t first, std::size_t last,
                    const LeafCorners* corners) const noexcept {
  if (frame_.is_exact()) {
    HWY_DYNAMIC_DISPATCH(FillFromFloats)(mesh_, corners, leaves, first, last);
  } else {
    HWY_DYNAMIC_DISPATCH(FillFromDoubles)(mesh_, corners, frame_.origin, leaves, first, last);
  }
}


void name_triangles(std::span<const Center> centers, LeafBlock& leaf) noexcept {
  for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
    leaf.tagged_triangle[lane] = lane < centers.size() ? centers[lane].triangle : no_triangle;
  }
}

}  // namespace keepout

#endif  // HWY_ONCE
