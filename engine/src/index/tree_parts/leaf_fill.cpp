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

#include "vertex_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

/// Writes the corners of some triangles in lexicographic order; equal corners keep their order, as
/// in corner_order(). Returns a bit for each triangle whose order is an odd permutation. Corners
/// are ordered before the origin is subtracted, because rounding could make different corners
/// equal.
template <class Number>
HWY_INLINE std::uint32_t write_in_order(const Place<Number>& a, const Place<Number>& b,
                                        const Place<Number>& c, const Vec3& origin,
                                        std::size_t first, LeafBlock& leaf) {
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
  hn::StoreMaskBits(Lanes<Number>(), hn::Xor(hn::Xor(b_before_a, c_before_a), c_before_b), bits);
  return (bits[0] | std::uint32_t{bits[1]} << 8) << first;
}

/// Writes the numbers of the triangles, and the bits of odd permutations.
HWY_INLINE void write_tags(const LeafBlock& from, std::uint32_t odd, LeafBlock& leaf) {
  const hn::CappedTag<std::uint32_t, LeafBlock::lanes> d;
  const auto bit = hn::Set(d, LeafBlock::odd);
  for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(d)) {
    const auto named = hn::Load(d, from.tagged_triangle + first);
    const auto shift = hn::Sub(hn::Set(d, 31), hn::Iota(d, static_cast<std::uint32_t>(first)));
    const auto parity = hn::And(hn::Shl(hn::Set(d, odd), shift), bit);
    const auto is_unused = hn::Eq(named, hn::Set(d, no_triangle));
    hn::Store(hn::IfThenElse(is_unused, named, hn::Or(hn::AndNot(bit, named), parity)), d,
              leaf.tagged_triangle + first);
  }
}

/// The vertices of the triangles in the lanes of a leaf. Unused lanes repeat lane 0.
using CornersOfLeaf = Corners[LeafBlock::lanes];

HWY_INLINE bool is_full(const LeafBlock& leaf) { return leaf.is_used(LeafBlock::lanes - 1); }

HWY_INLINE void look_up(const Corners* triangles, const LeafBlock& leaf, CornersOfLeaf& corners) {
  if (is_full(leaf)) [[likely]] {
    for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
      corners[lane] = triangles[leaf.triangle(lane)];
    }
    return;
  }
  for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
    corners[lane] = triangles[leaf.triangle(leaf.is_used(lane) ? lane : 0)];
  }
}

/// Returns true if two corners of a triangle have the same x. Then their order may depend on digits
/// that rounding removes. Otherwise rounding, which is monotonic, keeps their order.
HWY_INLINE bool has_tie(const Place<float>& a, const Place<float>& b, const Place<float>& c) {
  const auto tie = hn::Or(hn::Eq(a.x, b.x), hn::Or(hn::Eq(b.x, c.x), hn::Eq(c.x, a.x)));
  return !hn::AllFalse(Lanes<float>(), tie);
}

/// Fills a leaf from the doubles of its vertices.
HWY_INLINE void fill_leaf(const Vec3* vertices, const CornersOfLeaf& corners, const Vec3& origin,
                          const LeafBlock& from, LeafBlock& leaf) {
  std::uint32_t odd = 0;
  for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(Lanes<double>())) {
    Place<double> place[3];
    for (std::size_t c = 0; c < 3; ++c) {
      read([&](std::size_t lane) -> const Vec3& { return vertices[corners[first + lane][c]]; },
           place[c]);
    }
    odd |= write_in_order<double>(place[0], place[1], place[2], origin, first, leaf);
  }
  write_tags(from, odd, leaf);
}

/// Fills a leaf from the floats of its corners, which read_place(first lane, corner, place) reads.
/// Returns false if the order of corners depends on digits that floats lack.
template <class Read>
HWY_INLINE bool fill_leaf(const Read& read_place, bool are_exact, const LeafBlock& from,
                          LeafBlock& leaf) {
  std::uint32_t odd = 0;
  for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(Lanes<float>())) {
    Place<float> place[3];
    for (std::size_t c = 0; c < 3; ++c) read_place(first, c, place[c]);
    if (!are_exact && has_tie(place[0], place[1], place[2])) return false;
    odd |= write_in_order<float>(place[0], place[1], place[2], Vec3::Zero(), first, leaf);
  }
  write_tags(from, odd, leaf);
  return true;
}

HWY_INLINE void fill_leaf(const Vec3* vertices, const CornersOfLeaf& corners,
                          const LeafFrame& frame, const LeafBlock& from, LeafBlock& leaf) {
  const auto read_place = [&](std::size_t first, std::size_t c, Place<float>& place) HWY_ATTR {
    read([&](std::size_t lane) -> const Vec3& { return vertices[corners[first + lane][c]]; },
         frame.origin, place);
  };
  if (!fill_leaf(read_place, frame.is_exact(), from, leaf)) {
    fill_leaf(vertices, corners, frame.origin, from, leaf);
  }
}

/// Fetches a vertex, which may be in two cache lines.
HWY_INLINE void fetch(const Vec3& vertex) {
  hwy::Prefetch(&vertex.x());
  hwy::Prefetch(&vertex.z());
}

constexpr std::size_t vertices_ahead = 4;
constexpr std::size_t triangles_ahead = 12;
constexpr std::size_t sources_ahead = 24;

/// Without prefetching, the processor would wait for nearly every read. So the triangle numbers of
/// a leaf are fetched many leaves ahead, then its triangles, then its vertices.
void FillLeaves(const Mesh& mesh, const LeafFrame& frame, std::span<const LeafBlock> leaves,
                std::size_t first, std::size_t last, LeafBlock* to) {
  const Corners* triangles = mesh.triangles().data();
  const Vec3* vertices = mesh.vertices().data();
  CornersOfLeaf looked_up[vertices_ahead];
  // The previous call has fetched these.
  for (std::size_t i = first; i < std::min(first + vertices_ahead, leaves.size()); ++i) {
    look_up(triangles, leaves[i], looked_up[i % vertices_ahead]);
  }
  for (std::size_t i = first; i < last; ++i) {
    CornersOfLeaf& its = looked_up[i % vertices_ahead];
    fill_leaf(vertices, its, frame, leaves[i], *to++);
    if (i + sources_ahead < leaves.size()) hwy::Prefetch(leaves[i + sources_ahead].tagged_triangle);
    if (i + triangles_ahead < leaves.size() && is_full(leaves[i + triangles_ahead])) {
      const LeafBlock& ahead = leaves[i + triangles_ahead];
      for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
        hwy::Prefetch(&triangles[ahead.triangle(lane)]);
      }
    }
    if (i + vertices_ahead < leaves.size()) {
      look_up(triangles, leaves[i + vertices_ahead], its);
      for (const Corners& corners : its) {
        for (const VertexId v : corners) fetch(vertices[v]);
      }
    }
  }
}

constexpr std::size_t width = hn::MaxLanes(Lanes<float>());

/// Returns the positions at some entries of a table, in registers of eight or more lanes.
HWY_INLINE hn::Vec<Lanes<float>> table_lookup(const float (&table)[LeafPoints::lanes],
                                              hn::Vec<hn::RebindToUnsigned<Lanes<float>>> entry) {
  const Lanes<float> d;
  const hn::RebindToUnsigned<Lanes<float>> entries;
  const auto index = hn::IndicesFromVec(d, hn::And(entry, hn::Set(entries, width - 1)));
  auto found = hn::TableLookupLanes(hn::Load(d, table), index);
  for (std::size_t begin = width; begin < LeafVertices::most; begin += width) {
    const auto is_here =
        hn::RebindMask(d, hn::Gt(entry, hn::Set(entries, static_cast<std::uint32_t>(begin - 1))));
    found = hn::IfThenElse(is_here, hn::TableLookupLanes(hn::Load(d, table + begin), index), found);
  }
  return found;
}

/// Reads each vertex of a leaf once, and distributes it to the corners in registers. Returns false
/// if the order of corners depends on digits that floats lack.
HWY_INLINE bool fill_leaf(const Vec3* vertices, const LeafVertices& its, const LeafFrame& frame,
                          const LeafBlock& from, LeafPoints& points, LeafBlock& leaf) {
  const Lanes<float> d;
  const hn::RebindToUnsigned<Lanes<float>> entries;
  const hn::Rebind<std::uint8_t, Lanes<float>> bytes;
  for (std::size_t first = 0; first < LeafVertices::most; first += width) {
    Place<float> place;
    read(
        [&](std::size_t lane) -> const Vec3& {
          const std::size_t entry = first + lane;
          return vertices[its.vertex[entry < LeafVertices::most ? entry : 0]];
        },
        frame.origin, place);
    hn::Store(place.x, d, points.position[0] + first);
    hn::Store(place.y, d, points.position[1] + first);
    hn::Store(place.z, d, points.position[2] + first);
  }
  points.is_known = true;
  const auto look_up_place = [&](std::size_t first, std::size_t c, Place<float>& place) HWY_ATTR {
    const auto entry = hn::PromoteTo(entries, hn::LoadU(bytes, its.corner[c] + first));
    place = {table_lookup(points.position[0], entry), table_lookup(points.position[1], entry),
             table_lookup(points.position[2], entry)};
  };
  return fill_leaf(look_up_place, frame.is_exact(), from, leaf);
}

void FillFromVertices(const Mesh& mesh, const LeafFrame& frame, const LeafVertices* known,
                      std::span<const LeafBlock> leaves, std::size_t first, std::size_t last,
                      LeafBlock* to, LeafPoints* points) {
  const Vec3* vertices = mesh.vertices().data();
  for (std::size_t i = first; i < last; ++i, ++to, ++points) {
    if (i + sources_ahead < leaves.size()) hwy::Prefetch(leaves[i + sources_ahead].tagged_triangle);
    if (i + vertices_ahead < leaves.size()) {
      for (const VertexId v : known[i + vertices_ahead].vertex) fetch(vertices[v]);
    }
    points->is_known = false;
    if (width >= 8 && known[i].is_complete() &&
        fill_leaf(vertices, known[i], frame, leaves[i], *points, *to)) [[likely]] {
      continue;
    }
    CornersOfLeaf corners;
    look_up(mesh.triangles().data(), leaves[i], corners);
    fill_leaf(vertices, corners, frame, leaves[i], *to);
  }
}

void CopyLeaves(const LeafBlock* from, std::size_t count, bool bypass, LeafBlock* to) {
  static_assert(sizeof(LeafBlock) % (LeafBlock::lanes * sizeof(float)) == 0);
  const Lanes<float> d;
  const float* source = from->corner[0][0];
  float* target = to->corner[0][0];
  const std::size_t size = count * (sizeof(LeafBlock) / sizeof(float));
  if (!bypass) {
    for (std::size_t i = 0; i < size; i += width) hn::Store(hn::Load(d, source + i), d, target + i);
    return;
  }
  for (std::size_t i = 0; i < size; i += width) hn::Stream(hn::Load(d, source + i), d, target + i);
  hwy::FlushStream();
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

HWY_EXPORT(FillLeaves);
HWY_EXPORT(FillFromVertices);
HWY_EXPORT(AreFloats);
HWY_EXPORT(CopyLeaves);

void LeafVertices::collect(const Corners* triangles, const LeafBlock& leaf) noexcept {
  std::size_t count = 0;
  for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
    const Corners& its = triangles[leaf.triangle(leaf.is_used(lane) ? lane : 0)];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t entry =
          static_cast<std::size_t>(std::find(vertex, vertex + count, its[c]) - vertex);
      if (entry == most) {
        corner[0][0] = 1;  // not complete
        return;
      }
      vertex[entry] = its[c];
      count = std::max(count, entry + 1);
      corner[c][lane] = static_cast<std::uint8_t>(entry);
    }
  }
  std::fill(vertex + count, vertex + most, vertex[0]);
}

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

void LeafFill::fill(std::span<const LeafBlock> leaves, std::size_t first, std::size_t last,
                    LeafBlock* to) const noexcept {
  HWY_DYNAMIC_DISPATCH(FillLeaves)(mesh_, frame_, leaves, first, last, to);
}

void LeafFill::fill(std::span<const LeafBlock> leaves, std::size_t first, std::size_t last,
                    LeafBlock* to, const LeafVertices* vertices,
                    LeafPoints* points) const noexcept {
  HWY_DYNAMIC_DISPATCH(FillFromVertices)(mesh_, frame_, vertices, leaves, first, last, to, points);
}

void name_triangles(std::span<const Center> centers, LeafBlock& leaf) noexcept {
  for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
    leaf.tagged_triangle[lane] = lane < centers.size() ? centers[lane].triangle : no_triangle;
  }
}

void copy_leaves(const LeafBlock* from, std::size_t count, bool bypass, LeafBlock* to) noexcept {
  HWY_DYNAMIC_DISPATCH(CopyLeaves)(from, count, bypass, to);
}

}  // namespace keepout

#endif  // HWY_ONCE
