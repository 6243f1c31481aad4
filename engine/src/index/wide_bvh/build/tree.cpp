// SPDX-License-Identifier: BSD-3-Clause
#include "../tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <utility>
#include <vector>

#include "../../../parallel.h"
#include "../../tree_parts/median_split.h"
#include "enclosure.h"
#include "keepout/error.h"

namespace keepout {

static_assert(WideBvh::most_triangles == LeafBlock::most_triangles);

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

constexpr std::size_t rounded_up_quotient(std::size_t a, std::size_t b) { return (a + b - 1) / b; }

/// Returns the capacities of the levels in triangles: of the root, of its children and so on down
/// to the leaves. All nodes of a level have the same capacity. So all leaves but the last are full,
/// and the rank of a triangle alone determines its place.
std::vector<std::size_t> capacities(std::size_t count) {
  std::vector<std::size_t> all{LeafBlock::lanes};
  do {
    all.push_back(all.back() * NodeBlock::lanes);
  } while (all.back() < count);
  std::reverse(all.begin(), all.end());
  return all;
}

/// Brings triangles into the order of the leaves. It splits them repeatedly at the median along the
/// axis of their largest spread.
class Division {
 public:
  Division(const Mesh& mesh, unsigned threads, std::span<LeafBlock> leaves)
      : leaves_(leaves), centers_(centers_of(mesh, threads)), spare_(centers_.size()) {
    divide(centers_, spare_, 0, capacities(centers_.size()).front(), threads);
  }

 private:
  using Centers = std::span<Center>;

  /// Distributes the triangles of rank `begin` and above to leaves. `capacity`: of a child of the
  /// node that is filled. `spare` has capacity for the centers, and is overwritten.
  void divide(Centers centers, Centers spare, std::size_t begin, std::size_t capacity,
              unsigned threads) {
    while (capacity > LeafBlock::lanes && centers.size() <= capacity) capacity /= NodeBlock::lanes;
    if (centers.size() <= capacity) {
      return name_triangles(centers, leaves_[begin / LeafBlock::lanes]);
    }
    const std::size_t parts = rounded_up_quotient(centers.size(), capacity);
    const std::size_t middle = parts / 2 * capacity;
    constexpr std::size_t worth_a_thread = 4096;
    threads =
        static_cast<unsigned>(std::min<std::size_t>(threads, centers.size() / worth_a_thread + 1));
    split(centers, spare, middle, threads);
    // Each thread gets about as many triangles as any other.
    const std::size_t for_front = (threads * middle + centers.size() / 2) / centers.size();
    const auto in_front =
        static_cast<unsigned>(std::clamp<std::size_t>(for_front, 1, std::max(threads, 2u) - 1));
    const auto front = [&] {
      divide(spare.first(middle), centers.first(middle), begin, capacity, in_front);
    };
    const auto back = [&] {
      divide(spare.subspan(middle), centers.subspan(middle), begin + middle, capacity,
             std::max(threads, 2u) - in_front);
    };
    run_both(threads, front, back);
  }

  static void split(Centers from, Centers to, std::size_t middle, unsigned threads) {
    struct Extent {
      std::array<float, 3> low, high;
      void include(const std::array<float, 3>& least, const std::array<float, 3>& most) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          low[axis] = std::min(low[axis], least[axis]);
          high[axis] = std::max(high[axis], most[axis]);
        }
      }
    };
    Extent all{from.front().position, from.front().position};
    const auto include = [&](Extent extent, std::size_t begin, std::size_t end) {
      for (const Center& center : from.subspan(begin, end - begin)) {
        extent.include(center.position, center.position);
      }
      return extent;
    };
    if (threads > 1) {
      std::vector<Extent> shared(threads, all);
      share_equally(from.size(), threads,
                    [&](std::size_t part, std::size_t begin, std::size_t end) {
                      shared[part] = include(all, begin, end);
                    });
      for (const Extent& extent : shared) all.include(extent.low, extent.high);
    } else {
      all = include(all, 0, from.size());
    }
    const auto& [low, high] = all;
    std::size_t axis = 0;
    for (const std::size_t other : {1u, 2u}) {
      if (high[other] - low[other] > high[axis] - low[axis]) axis = other;
    }
    split_at(from, to, middle, low[axis], high[axis], threads,
             [axis](const Center& center) { return center.position[axis]; });
  }

  std::span<LeafBlock> leaves_;
  BlockVector<Center> centers_;
  BlockVector<Center> spare_;
};

/// Returns the greatest float below x.
float previous(float x) noexcept {
  if (x == 0.0f) return -std::numeric_limits<float>::denorm_min();
  const auto bits = std::bit_cast<std::uint32_t>(x);
  if (x == -infinity) return x;
  return std::bit_cast<float>(x > 0.0f ? bits - 1 : bits + 1);
}

float next(float x) noexcept { return -previous(-x); }

/// Enlarges boxes around floats so that they contain the mesh, whose coordinates differ from the
/// floats. Rounding keeps the order, so the mesh's extreme is within one float of the floats'
/// extreme.
void widen(NodeBlock& node) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (float& low : node.low[axis]) low = previous(low);
    for (float& high : node.high[axis]) high = next(high);
  }
}

/// Fills the lanes from the first unused one on with boxes at infinity, which no query reaches.
void close_lanes(NodeBlock& node, CylinderBlock& cylinders, std::size_t first) noexcept {
  for (std::size_t lane = first; lane < NodeBlock::lanes; ++lane) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      node.low[axis][lane] = infinity;
      node.high[axis][lane] = infinity;
    }
    node.child[lane] = 0;
    close_lane(cylinders, lane);
  }
}

}  // namespace

WideBvh::Tree::Tree(const WideBvh& index) : index_(index) {
  const std::size_t count = mesh().triangle_count();
  if (count > most_triangles) {
    throw Error("a wide_bvh holds at most 2^31 - 1 triangles: split or decimate the mesh");
  }
  leaves_.resize(rounded_up_quotient(count, LeafBlock::lanes));
  std::size_t nodes = 0;
  for (const std::size_t capacity : capacities(count)) {
    if (capacity > LeafBlock::lanes) nodes += rounded_up_quotient(count, capacity);
  }
  nodes_.resize(nodes);
  cylinders_.resize(nodes);
}

void WideBvh::Tree::divide(unsigned threads) { Division(mesh(), threads, leaves_); }

void WideBvh::Tree::divide(std::span<const TriangleId> order) noexcept {
  for (std::size_t i = 0; i < leaves_.size() * LeafBlock::lanes; ++i) {
    leaves_[i / LeafBlock::lanes].tagged_triangle[i % LeafBlock::lanes] =
        i < order.size() ? order[i] : no_triangle;
  }
}

void WideBvh::Tree::collect_vertices(unsigned threads) {
  if (!vertices_.empty()) return;
  BlockVector<LeafVertices> vertices(leaves_.size());
  const Corners* triangles = mesh().triangles().data();
  share_ranges(leaves_.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) vertices[i].collect(triangles, leaves_[i]);
  });
  vertices_ = std::move(vertices);
}

void WideBvh::Tree::fit(const LeafFill& fill, unsigned threads) {
  frame_ = fill.frame();

  // Each level comes after the one above it, so the lowest level is last.
  std::size_t size = rounded_up_quotient(leaves_.size(), NodeBlock::lanes);
  std::size_t begin = nodes_.size() - size;
  constexpr std::size_t share = 128;  // nodes, worked on at a time
  share_ranges(size, threads, share, [&](std::size_t from, std::size_t to) {
    // The leaves after these belong to another thread.
    const std::span shared =
        std::span(leaves_).first(std::min(to * NodeBlock::lanes, leaves_.size()));
    for (std::size_t i = from; i < to; ++i) {
      const std::size_t first = i * NodeBlock::lanes;
      const std::size_t last = std::min(first + NodeBlock::lanes, shared.size());
      fit_leaves(fill, shared, begin + i, first, last);
    }
  });
  while (size > 1) {
    const std::size_t children = size;
    const std::size_t first_child = begin;
    size = rounded_up_quotient(children, NodeBlock::lanes);
    begin -= size;
    share_ranges(size, threads, share, [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) {
        const std::size_t first = i * NodeBlock::lanes;
        enclose_nodes(begin + i, first_child + first,
                      first_child + std::min(first + NodeBlock::lanes, children));
      }
    });
  }
}

/// Makes a node of the leaves first .. last - 1. They are made in a copy, so that all that is made
/// of them reads it from the nearest cache.
void WideBvh::Tree::fit_leaves(const LeafFill& fill, std::span<const LeafBlock> leaves,
                               std::size_t self, std::size_t first, std::size_t last) noexcept {
  SixteenLeaves made;
  if (vertices_.empty()) {
    fill.fill(leaves, first, last, made.leaf);
  } else {
    fill.fill(leaves, first, last, made.leaf, vertices_.data(), made.points);
  }
  NodeBlock& node = nodes_[self];
  for (std::size_t lane = 0; lane < NodeBlock::lanes; ++lane) {
    if (first + lane >= last) {
      made.leaf[lane] = made.leaf[lane - 1];
      made.points[lane] = made.points[lane - 1];
    }
    node.child[lane] =
        static_cast<std::uint32_t>(std::min(first + lane, last - 1)) | NodeBlock::leaf_bit;
  }
  enclose(made, node, cylinders_[self]);
  if (!frame_.is_exact()) widen(node);
  close_lanes(node, cylinders_[self], last - first);
  constexpr std::size_t most_in_cache = std::size_t{1} << 24;  // bytes
  const bool bypass = leaves_.size() * sizeof(LeafBlock) > most_in_cache;
  copy_leaves(made.leaf, last - first, bypass, &leaves_[first]);
}

/// Makes a node of the nodes first .. last - 1.
void WideBvh::Tree::enclose_nodes(std::size_t self, std::size_t first, std::size_t last) noexcept {
  for (std::size_t child = first; child < last; ++child) {
    enclose(nodes_[child], cylinders_[child], nodes_[self], cylinders_[self], child - first);
    nodes_[self].child[child - first] = static_cast<std::uint32_t>(child);
  }
  close_lanes(nodes_[self], cylinders_[self], last - first);
}

std::size_t WideBvh::Tree::memory() const noexcept {
  return nodes_.capacity() * sizeof(NodeBlock) + cylinders_.capacity() * sizeof(CylinderBlock) +
         leaves_.capacity() * sizeof(LeafBlock) + vertices_.capacity() * sizeof(LeafVertices);
}

}  // namespace keepout
