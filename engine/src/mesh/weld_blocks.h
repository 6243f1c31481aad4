// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "../huge_pages.h"
#include "../parallel.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// A point as bits, for an exact comparison: -0 must have become 0.
template <class Scalar>
using ExactPoint = std::array<Scalar, 3>;

/// Multiplies two numbers and folds the product, so that each bit depends on many bits of both.
inline std::uint64_t folded_product(std::uint64_t a, std::uint64_t b) noexcept {
  __extension__ using Wide = unsigned __int128;
  const Wide product = Wide{a} * b;
  return static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64);
}

// Any odd constants with many bits set will do.
constexpr std::uint64_t hash_key[3] = {0x9e3779b97f4a7c15u, 0xbf58476d1ce4e5b9u,
                                       0x94d049bb133111ebu};

inline std::uint64_t hash(const ExactPoint<float>& point) noexcept {
  const std::uint64_t xy = std::bit_cast<std::uint32_t>(point[0]) |
                           std::uint64_t{std::bit_cast<std::uint32_t>(point[1])} << 32;
  return folded_product(xy ^ hash_key[0], std::bit_cast<std::uint32_t>(point[2]) ^ hash_key[1]);
}

inline std::uint64_t hash(const ExactPoint<double>& point) noexcept {
  const std::uint64_t xy = folded_product(std::bit_cast<std::uint64_t>(point[0]) ^ hash_key[0],
                                          std::bit_cast<std::uint64_t>(point[1]) ^ hash_key[1]);
  return folded_product(xy ^ std::bit_cast<std::uint64_t>(point[2]), hash_key[2]);
}

/// Numbers points by their first appearance; equal points get equal numbers.
///
/// An open hash table of (part of the hash, number). The points are stored separately, so that the
/// table is twice as dense in the caches. They are in blocks, so that they need not move when the
/// table grows.
template <class Scalar>
class PointNumbers {
 public:
  using Point = ExactPoint<Scalar>;

  /// `expected`: the likely number of different points; more are allowed.
  explicit PointNumbers(std::size_t expected)
      : slots_(vector_in_huge_pages<Slot>(std::bit_ceil(expected + expected / 3 + 16))) {}

  std::size_t size() const noexcept { return size_; }
  const Point& operator[](std::size_t number) const noexcept {
    return blocks_[number / block_size][number % block_size];
  }

  /// Returns the numbers of points with given hashes. Precondition: there are fewer than
  /// no_triangle different points in all.
  void number(std::span<const Point> points, std::span<const std::uint64_t> hashes,
              std::span<VertexId> numbers) {
    make_room(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      // Prefetches first the slot, then the point that it names.
      if (i + 2 * ahead < points.size()) __builtin_prefetch(&slots_[home(hashes[i + 2 * ahead])]);
      if (i + ahead < points.size()) {
        const Slot& slot = slots_[home(hashes[i + ahead])];
        if (slot.tag == tag(hashes[i + ahead])) __builtin_prefetch(&(*this)[slot.number]);
      }
      numbers[i] = number(points[i], hashes[i]);
    }
  }

  /// Frees the table and keeps the points.
  void close() noexcept { slots_ = {}; }

 private:
  static constexpr std::size_t block_size = std::size_t{1} << 16;
  static constexpr std::size_t ahead = 12;

  struct Slot {
    std::uint32_t tag = 0;  // 0: empty
    VertexId number = 0;
  };

  std::size_t home(std::uint64_t hash) const noexcept { return hash & (slots_.size() - 1); }
  static std::uint32_t tag(std::uint64_t hash) noexcept {
    return static_cast<std::uint32_t>(hash >> 32) | 1u;
  }

  VertexId number(const Point& point, std::uint64_t hash) noexcept {
    for (std::size_t s = home(hash);; s = (s + 1) & (slots_.size() - 1)) {
      Slot& slot = slots_[s];
      if (slot.tag == 0) {
        slot = {tag(hash), static_cast<VertexId>(size_)};
        blocks_[size_ / block_size][size_ % block_size] = point;
        return static_cast<VertexId>(size_++);
      }
      if (slot.tag == tag(hash) && (*this)[slot.number] == point) return slot.number;
    }
  }

  /// Makes capacity for `more` points.
  void make_room(std::size_t more) {
    while (blocks_.size() * block_size < size_ + more) {
      blocks_.push_back(std::make_unique_for_overwrite<Point[]>(block_size));
    }
    if (4 * (size_ + more) <= 3 * slots_.size()) return;
    slots_ = {};  // the table can be rebuilt from the points
    slots_ = vector_in_huge_pages<Slot>(std::bit_ceil(2 * (size_ + more)));
    for (std::size_t p = 0; p < size_; ++p) {
      const std::uint64_t h = hash((*this)[p]);
      std::size_t s = home(h);
      while (slots_[s].tag != 0) s = (s + 1) & (slots_.size() - 1);
      slots_[s] = {tag(h), static_cast<VertexId>(p)};
    }
  }

  std::vector<Slot> slots_;
  std::vector<std::unique_ptr<Point[]>> blocks_;
  std::size_t size_ = 0;
};

/// Triangles in a block. Their corners can be numbered in 16 bits.
constexpr std::size_t weld_block = 16'384;

/// The different points of a block, in the order of their first appearance.
template <class Scalar>
class BlockPoints {
 public:
  using Point = ExactPoint<Scalar>;

  void clear() {
    std::fill(slots_.begin(), slots_.end(), empty);
    points_.clear();
    hashes_.clear();
  }

  VertexId number(const Point& point) {
    const std::uint64_t h = hash(point);
    for (std::size_t s = h % slot_count;; s = (s + 1) % slot_count) {
      if (slots_[s] == empty) {
        slots_[s] = static_cast<std::uint16_t>(points_.size());
        points_.push_back(point);
        hashes_.push_back(h);
        return slots_[s];
      }
      if (points_[slots_[s]] == point) return slots_[s];
    }
  }

  std::span<const Point> points() const noexcept { return points_; }
  std::span<const std::uint64_t> hashes() const noexcept { return hashes_; }

 private:
  static constexpr std::size_t slot_count = 4 * weld_block;
  static constexpr std::uint16_t empty = slot_count - 1;
  static_assert(3 * weld_block < empty);

  std::vector<std::uint16_t> slots_ = std::vector<std::uint16_t>(slot_count);
  std::vector<Point> points_;
  std::vector<std::uint64_t> hashes_;
};

/// Welds triangles block by block. A thread finds the different points of its block. When all
/// earlier blocks have their numbers, the points of this block get theirs. Then the thread writes
/// the numbers to the triangles. So vertices are numbered by their first use, whatever the number
/// of threads is.
///
/// Each thread has its own reader. make_reader()(first, corners, number) is called with the part of
/// `triangles` that begins at `first`. It must write number(point) for each corner, in order.
template <class Scalar, class MakeReader>
Surface weld_blocks(std::vector<Corners> triangles, unsigned threads,
                    const MakeReader& make_reader) {
  // A closed surface has half as many vertices as triangles.
  PointNumbers<Scalar> numbers(triangles.size() / 2);

  using Reader = decltype(make_reader());
  struct Worker {
    std::vector<Corners>& triangles;
    PointNumbers<Scalar>& numbers;
    Reader reader;
    BlockPoints<Scalar> points;
    std::vector<VertexId> ids;

    std::span<Corners> block_of(std::size_t block) const {
      const std::size_t first = block * weld_block;
      return std::span(triangles).subspan(first, std::min(weld_block, triangles.size() - first));
    }

    void prepare(std::size_t block) {
      points.clear();
      reader(block * weld_block, block_of(block),
             [&](const ExactPoint<Scalar>& point) { return points.number(point); });
    }
    void commit(std::size_t) {
      ids.resize(points.points().size());
      numbers.number(points.points(), points.hashes(), ids);
    }
    void finish(std::size_t block) {
      for (Corners& corners : block_of(block)) {
        for (VertexId& v : corners) v = ids[v];
      }
    }
  };
  share_blocks_in_order((triangles.size() + weld_block - 1) / weld_block, threads, [&] {
    return Worker{triangles, numbers, make_reader(), {}, {}};
  });
  numbers.close();

  auto vertices = vector_in_huge_pages<Vec3>(numbers.size());
  share_ranges(vertices.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const ExactPoint<Scalar>& point = numbers[v];
      vertices[v] = Vec3(point[0], point[1], point[2]);
    }
  });
  return {std::move(vertices), std::move(triangles)};
}

}  // namespace keepout
