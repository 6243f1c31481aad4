// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "../huge_pages.h"
#include "../parallel.h"
#include "keepout/mesh/mesh.h"
#include "point_numbers.h"

namespace keepout {

/// Triangles that are welded at a time. Their corners can be numbered in 16 bits.
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

/// Welds triangles block by block: a thread finds the different points of its block, gives them
/// their numbers when all blocks before have theirs, and then puts the numbers into the triangles.
/// So vertices are numbered by their first use, whatever the number of threads.
///
/// Each thread has a reader of its own: make_reader()(first, corners, number), called with the part
/// of `triangles` that begins at `first`, is to put number(point) for each corner, in their order.
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
