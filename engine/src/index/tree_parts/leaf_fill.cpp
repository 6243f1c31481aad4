// SPDX-License-Identifier: BSD-3-Clause
#include "leaf_fill.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>

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

/// The corners of a leaf's triangles, each with one unused number. [length]
template <class Number>
struct alignas(64) Gathered {
  Number corner[3][LeafBlock::lanes][4];

  HWY_INLINE Place<Number> place(std::size_t c, std::size_t first) const {
    const Lanes<Number> d;
    Place<Number> place;
    hn::Vec<Lanes<Number>> unused;
    hn::LoadInterleaved4(d, corner[c][first], place.x, place.y, place.z, unused);
    return place;
  }
};

HWY_INLINE void copy(const LeafFill::FloatVertex& from, float (&to)[4]) {
  std::memcpy(to, from.x, sizeof to);  // one instruction
}

HWY_INLINE void copy(const Vec3& from, double (&to)[4]) {
  to[0] = from.x();
  to[1] = from.y();
  to[2] = from.z();
  to[3] = 0.0;
}

/// Writes the corners in lexicographic order; equal corners keep their order, as in corner_order().
/// Corners are ordered before the origin is subtracted, because rounding could make different
/// corners equal.
template <class Number>
HWY_INLINE void write_in_order(const Gathered<Number>& from, const Vec3& origin, LeafBlock& leaf) {
  const Lanes<Number> d;
  std::uint32_t odd = 0;
  for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(d)) {
    const Place<Number> a = from.place(0, first);
    const Place<Number> b = from.place(1, first);
    const Place<Number> c = from.place(2, first);
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
  for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
    const std::uint32_t parity = odd << (31 - lane) & LeafBlock::odd;
    const std::uint32_t named = leaf.triangle(lane) | parity;
    leaf.tagged_triangle[lane] = leaf.is_used(lane) ? named : no_triangle;
  }
}

/// The vertices of a leaf's triangles.
using VerticesOfLeaf = Corners[LeafBlock::lanes];

HWY_INLINE bool is_full(const LeafBlock& leaf) { return leaf.is_used(LeafBlock::lanes - 1); }

HWY_INLINE void look_up(const Corners* triangles, const LeafBlock& leaf, VerticesOfLeaf& vertices) {
  if (is_full(leaf)) [[likely]] {
    for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
      vertices[lane] = triangles[leaf.triangle(lane)];
    }
    return;
  }
  for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
    vertices[lane] = triangles[leaf.triangle(leaf.is_used(lane) ? lane : 0)];
  }
}

/// Without prefetching, the processor would wait for nearly every read. So the triangle numbers of
/// a leaf are fetched many leaves ahead, then its triangles, then its vertices.
template <class Number, class Vertex>
HWY_INLINE void fill_leaves(const Corners* triangles, const Vertex* vertices, const Vec3& origin,
                            std::span<LeafBlock> leaves, std::size_t first, std::size_t last) {
  constexpr std::size_t vertices_ahead = 4;
  constexpr std::size_t triangles_ahead = 12;
  constexpr std::size_t sources_ahead = 24;
  VerticesOfLeaf looked_up[vertices_ahead];
  // The previous call has fetched these.
  for (std::size_t i = first; i < std::min(first + vertices_ahead, leaves.size()); ++i) {
    look_up(triangles, leaves[i], looked_up[i % vertices_ahead]);
  }
  for (std::size_t i = first; i < last; ++i) {
    VerticesOfLeaf& its = looked_up[i % vertices_ahead];
    Gathered<Number> gathered;
    for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
      for (std::size_t c = 0; c < 3; ++c) copy(vertices[its[lane][c]], gathered.corner[c][lane]);
    }
    if (i + sources_ahead < leaves.size()) hwy::Prefetch(leaves[i + sources_ahead].tagged_triangle);
    if (i + triangles_ahead < leaves.size() && is_full(leaves[i + triangles_ahead])) {
      const LeafBlock& ahead = leaves[i + triangles_ahead];
      for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
        hwy::Prefetch(&triangles[ahead.triangle(lane)]);
      }
    }
    if (i + vertices_ahead < leaves.size()) {
      LeafBlock& ahead = leaves[i + vertices_ahead];
      look_up(triangles, ahead, its);
      for (const Corners& corners : its) {
        for (const VertexId v : corners) hwy::Prefetch(&vertices[v]);
      }
      for (auto& corner : ahead.corner) {
        for (const auto& coordinates : corner) __builtin_prefetch(coordinates, 1);  // to be written
      }
    }
    write_in_order(gathered, origin, leaves[i]);
  }
}

void FillFromFloats(const Corners* triangles, const LeafFill::FloatVertex* vertices,
                    std::span<LeafBlock> leaves, std::size_t first, std::size_t last) {
  fill_leaves<float>(triangles, vertices, Vec3::Zero(), leaves, first, last);
}

void FillFromDoubles(const Corners* triangles, const Vec3* vertices, const Vec3& origin,
                     std::span<LeafBlock> leaves, std::size_t first, std::size_t last) {
  fill_leaves<double>(triangles, vertices, origin, leaves, first, last);
}

/// Rounds vertices to floats. Returns true if all keep their values.
bool RoundVertices(std::span<const Vec3> from, LeafFill::FloatVertex* to) {
  // Each read also covers the next coordinate, which has no effect.
  const hn::CappedTag<double, 4> d;
  const hn::Rebind<float, decltype(d)> floats;
  auto off = hn::Zero(d);
  const auto round = [&](const double* x, float* rounded) HWY_ATTR {
    for (std::size_t i = 0; i < 4; i += hn::Lanes(d)) {
      const auto exact = hn::LoadU(d, x + i);
      const auto nearest = hn::DemoteTo(floats, exact);
      hn::StoreU(nearest, floats, rounded + i);
      off = hn::Max(off, hn::Abs(hn::Sub(exact, hn::PromoteTo(d, nearest))));
    }
  };
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  const std::size_t last = from.size() - 1;
  for (std::size_t v = 0; v < last; ++v) round(from[v].data(), to[v].x);
  const double copied[4] = {from[last].x(), from[last].y(), from[last].z(), from[last].z()};
  round(copied, to[last].x);
  return hn::GetLane(hn::MaxOfLanes(d, off)) == 0.0;
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(FillFromFloats);
HWY_EXPORT(FillFromDoubles);
HWY_EXPORT(RoundVertices);

LeafFill::LeafFill(const Mesh& mesh, unsigned threads)
    : mesh_(mesh), vertices_(mesh.vertex_count()) {
  std::atomic<bool> are_floats = true;
  share_ranges(mesh.vertex_count(), threads, [&](std::size_t begin, std::size_t end) {
    if (!are_floats) return;
    const auto share = mesh.vertices().subspan(begin, end - begin);
    if (!HWY_DYNAMIC_DISPATCH(RoundVertices)(share, &vertices_[begin])) are_floats = false;
  });
  if (are_floats) return;
  // Corners that round to the same floats may still have an order, so the doubles are used.
  vertices_ = {};
  const Box& bounds = mesh.bounds();
  frame_.origin = bounds.center();
  // Half of a float's last digit, and of a double's for the subtraction of the origin. Below the
  // normal range of floats the last digit keeps its size.
  const double farthest =
      std::max((bounds.high - frame_.origin).maxCoeff(), (frame_.origin - bounds.low).maxCoeff());
  frame_.error = 0x1p-24 * (1.0 + 0x1p-20) * farthest + 0x1p-149;
}

void LeafFill::fill(std::span<LeafBlock> leaves, std::size_t first,
                    std::size_t last) const noexcept {
  const Corners* triangles = mesh_.triangles().data();
  if (frame_.is_exact()) {
    HWY_DYNAMIC_DISPATCH(FillFromFloats)(triangles, vertices_.data(), leaves, first, last);
  } else {
    HWY_DYNAMIC_DISPATCH(FillFromDoubles)
    (triangles, mesh_.vertices().data(), frame_.origin, leaves, first, last);
  }
}

void name_triangles(std::span<const Center> centers, LeafBlock& leaf) noexcept {
  for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
    leaf.tagged_triangle[lane] = lane < centers.size() ? centers[lane].triangle : no_triangle;
  }
}

}  // namespace keepout

#endif  // HWY_ONCE
