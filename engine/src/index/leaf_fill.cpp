// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "leaf_fill.h"

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "threads.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "index/leaf_fill.cpp"
#include <hwy/foreach_target.h>
// After it, for it tells for whom to compile.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, LeafBlock::lanes>;
using Values = hn::Vec<Doubles>;
using Choice = hn::Mask<Doubles>;

struct Place {
  Values x, y, z;
};

HWY_INLINE Choice is_before(const Place& a, const Place& b) {
  const Choice in_plane = hn::Or(hn::Lt(a.y, b.y), hn::And(hn::Eq(a.y, b.y), hn::Lt(a.z, b.z)));
  return hn::Or(hn::Lt(a.x, b.x), hn::And(hn::Eq(a.x, b.x), in_plane));
}

HWY_INLINE Place choose(Choice first, const Place& a, const Place& b) {
  return {hn::IfThenElse(first, a.x, b.x), hn::IfThenElse(first, a.y, b.y),
          hn::IfThenElse(first, a.z, b.z)};
}

/// The corners of a leaf's triangles as the mesh has them. [length]
struct alignas(64) Gathered {
  double corner[3][3][LeafBlock::lanes];  // [corner][axis][lane]

  HWY_INLINE Place place(std::size_t c, std::size_t first) const {
    const Doubles d;
    return {hn::Load(d, corner[c][0] + first), hn::Load(d, corner[c][1] + first),
            hn::Load(d, corner[c][2] + first)};
  }
};

HWY_INLINE void store(const Place& place, float (&corner)[3][LeafBlock::lanes], std::size_t first) {
  const hn::Rebind<float, Doubles> floats;
  hn::Store(hn::DemoteTo(floats, place.x), floats, corner[0] + first);
  hn::Store(hn::DemoteTo(floats, place.y), floats, corner[1] + first);
  hn::Store(hn::DemoteTo(floats, place.z), floats, corner[2] + first);
}

HWY_INLINE FloatBox box_around(const LeafBlock& leaf) {
  const hn::CappedTag<float, LeafBlock::lanes> d;
  FloatBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto low = hn::Load(d, leaf.corner[0][axis]);
    auto high = low;
    for (const auto& corner : leaf.corner) {
      for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(d)) {
        low = hn::Min(low, hn::Load(d, corner[axis] + first));
        high = hn::Max(high, hn::Load(d, corner[axis] + first));
      }
    }
    box.low[axis] = hn::GetLane(hn::MinOfLanes(d, low));
    box.high[axis] = hn::GetLane(hn::MaxOfLanes(d, high));
  }
  return box;
}

FloatBox fill_lanes(const Mesh& mesh, LeafBlock& leaf) {
  Gathered from;
  for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
    const Corners& corners = mesh.corners(leaf.triangle(leaf.is_used(lane) ? lane : 0));
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3& vertex = mesh.vertex(corners[c]);
      from.corner[c][0][lane] = vertex.x();
      from.corner[c][1][lane] = vertex.y();
      from.corner[c][2][lane] = vertex.z();
    }
  }

  // As corner_order does: equal corners keep their order.
  std::uint32_t odd = 0;
  const Doubles d;
  for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(d)) {
    const Place a = from.place(0, first);
    const Place b = from.place(1, first);
    const Place c = from.place(2, first);
    const Choice b_before_a = is_before(b, a);
    const Choice c_before_a = is_before(c, a);
    const Choice c_before_b = is_before(c, b);
    const Place lower = choose(b_before_a, b, a);
    const Place upper = choose(b_before_a, a, b);
    const Choice c_is_first =
        hn::Or(hn::And(b_before_a, c_before_b), hn::AndNot(b_before_a, c_before_a));
    const Choice c_is_not_last =
        hn::Or(hn::And(b_before_a, c_before_a), hn::AndNot(b_before_a, c_before_b));
    store(choose(c_is_first, c, lower), leaf.corner[0], first);
    store(choose(c_is_first, lower, choose(c_is_not_last, c, upper)), leaf.corner[1], first);
    store(choose(c_is_not_last, upper, c), leaf.corner[2], first);

    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::Xor(hn::Xor(b_before_a, c_before_a), c_before_b), bits);
    odd |= (bits[0] | std::uint32_t{bits[1]} << 8) << first;
  }
  for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
    const std::uint32_t parity = (odd >> lane & 1) != 0 ? LeafBlock::odd : 0;
    if (leaf.is_used(lane)) leaf.source[lane] = leaf.triangle(lane) | parity;
  }
  return box_around(leaf);
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(fill_lanes);

double float_error(const Mesh& mesh, unsigned threads) {
  std::atomic<double> largest = 0.0;
  for_ranges(threads, 0, mesh.vertex_count(), [&](std::size_t begin, std::size_t end) {
    double error = 0.0;
    for (const Vec3& v : mesh.vertices().subspan(begin, end - begin)) {
      error = std::max(error, (v - v.cast<float>().cast<double>()).cwiseAbs().maxCoeff());
    }
    double known = largest;
    while (error > known && !largest.compare_exchange_weak(known, error)) {
    }
  });
  return largest;
}

void fetch_corners(const Mesh& mesh, const LeafBlock& leaf) noexcept {
  for (std::size_t lane = 0; lane < LeafBlock::lanes && leaf.is_used(lane); ++lane) {
    hwy::Prefetch(&mesh.corners(leaf.triangle(lane)));
  }
}

void fetch_vertices(const Mesh& mesh, const LeafBlock& leaf) noexcept {
  for (std::size_t lane = 0; lane < LeafBlock::lanes && leaf.is_used(lane); ++lane) {
    for (const VertexId v : mesh.corners(leaf.triangle(lane))) hwy::Prefetch(&mesh.vertex(v));
  }
}

void name_triangles(std::span<const Center> centers, LeafBlock& leaf) noexcept {
  for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
    leaf.source[lane] = lane < centers.size() ? centers[lane].triangle : no_triangle;
  }
}

FloatBox fill_leaf(const Mesh& mesh, LeafBlock& leaf) noexcept {
  return HWY_DYNAMIC_DISPATCH(fill_lanes)(mesh, leaf);
}

}  // namespace keepout

#endif  // HWY_ONCE
