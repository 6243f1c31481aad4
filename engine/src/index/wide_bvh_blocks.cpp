// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// A tree from blocks that were built before, perhaps by another process: all that a traversal
// relies on is checked, in linear time.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "../geometry/corner_order.h"
#include "../parallel.h"
#include "enclosure.h"
#include "keepout/error.h"
#include "keepout/index/wide_bvh.h"

namespace keepout {
namespace {

void expect(bool holds) {
  if (!holds) throw Error("these blocks are no wide_bvh of this mesh");
}

/// Whether the box of a lane holds that of another node's.
bool holds(const NodeBlock& node, std::size_t lane, const NodeBlock& other, std::size_t of_other) {
  bool inside = true;
  for (int axis = 0; axis < 3; ++axis) {
    inside &= node.low[axis][lane] <= other.low[axis][of_other] &&
              other.high[axis][of_other] <= node.high[axis][lane];
  }
  return inside;
}

bool holds(const NodeBlock& node, std::size_t lane, const Vec3& low, const Vec3& high) {
  bool inside = true;
  for (int axis = 0; axis < 3; ++axis) {
    inside &= node.low[axis][lane] <= low[axis] && high[axis] <= node.high[axis][lane];
  }
  return inside;
}

bool is_out_of_reach(const NodeBlock& node, std::size_t lane) {
  constexpr float farthest = std::numeric_limits<float>::max();
  bool beyond = true;
  for (int axis = 0; axis < 3; ++axis) {
    beyond &= node.low[axis][lane] >= farthest && node.high[axis][lane] >= farthest;
  }
  return beyond;
}

/// Which lane of which node a leaf is in.
struct Place {
  std::uint32_t node = 0;
  std::uint32_t lane = NodeBlock::lanes;  // as yet none
};

class Check {
 public:
  Check(const Mesh& mesh, const BlockVector<NodeBlock>& nodes, const BlockVector<LeafBlock>& leaves)
      : mesh_(mesh), nodes_(nodes), leaves_(leaves) {}

  void run() {
    expect(!nodes_.empty() && nodes_.size() < NodeBlock::leaf && leaves_.size() < NodeBlock::leaf);
    check_nodes();
    seen_.resize(mesh_.triangle_count());
    std::atomic<std::size_t> triangles = 0;
    share_ranges(leaves_.size(), processors(), [&](std::size_t begin, std::size_t end) {
      std::size_t found = 0;
      for (std::size_t leaf = begin; leaf < end; ++leaf) {
        if (leaf + 6 < end) fetch_corners(leaves_[leaf + 6]);
        if (leaf + 3 < end) fetch_vertices(leaves_[leaf + 3]);
        found += check_leaf(leaf);
      }
      triangles += found;
    });
    // As many as there are, and none that is missing: so none is there twice.
    expect(triangles == mesh_.triangle_count());
    expect(std::find(seen_.begin(), seen_.end(), 0) == seen_.end());
  }

 private:
  /// That the nodes are one tree, that every leaf is in it once, and boxes hold those below.
  void check_nodes() {
    levels_.resize(nodes_.size(), 0);
    levels_[0] = 1;
    places_.resize(leaves_.size());
    std::size_t leaves = 0;
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      const NodeBlock& node = nodes_[n];
      expect(levels_[n] > 0 && node.is_used(0));  // its parent stands before it
      for (std::size_t lane = 0; lane < NodeBlock::lanes; ++lane) {
        if (!node.is_used(lane)) {
          expect(is_out_of_reach(node, lane));
          expect(lane + 1 == NodeBlock::lanes || !node.is_used(lane + 1));
        } else if ((node.child[lane] & NodeBlock::leaf) == 0) {
          check_child(n, lane);
        } else {
          const std::uint32_t leaf = node.child[lane] & ~NodeBlock::leaf;
          expect(leaf < leaves_.size() && places_[leaf].lane == NodeBlock::lanes);
          places_[leaf] = {static_cast<std::uint32_t>(n), static_cast<std::uint32_t>(lane)};
          ++leaves;
        }
      }
    }
    expect(leaves == leaves_.size());
  }

  void check_child(std::size_t parent, std::size_t lane) {
    const std::uint32_t child = nodes_[parent].child[lane];
    expect(child > parent && child < nodes_.size() && levels_[child] == 0);
    levels_[child] = static_cast<std::uint8_t>(levels_[parent] + 1);
    expect(levels_[child] <= WideBvh::most_levels);
    for (std::size_t below = 0; below < NodeBlock::lanes; ++below) {
      const NodeBlock& node = nodes_[child];
      expect(!node.is_used(below) || holds(nodes_[parent], lane, node, below));
    }
  }

  // What will be looked at soon: the mesh has its triangles in another order.

  void fetch_corners(const LeafBlock& leaf) const noexcept {
    for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
      const TriangleId t = leaf.triangle(lane);
      if (t >= mesh_.triangle_count()) continue;
      __builtin_prefetch(&mesh_.corners(t));
      __builtin_prefetch(&seen_[t], 1);
    }
  }

  void fetch_vertices(const LeafBlock& leaf) const noexcept {
    for (std::size_t lane = 0; lane < LeafBlock::lanes; ++lane) {
      const TriangleId t = leaf.triangle(lane);
      if (t >= mesh_.triangle_count()) continue;
      for (const VertexId v : mesh_.corners(t)) __builtin_prefetch(&mesh_.vertex(v));
    }
  }

  /// That a leaf is what is made of the mesh's triangles that it names, and in its box; and how
  /// many they are.
  std::size_t check_leaf(std::size_t number) {
    const LeafBlock& leaf = leaves_[number];
    LeafBlock expected;
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = -low;
    std::size_t used = 0;
    for (; used < LeafBlock::lanes && leaf.is_used(used); ++used) {
      const TriangleId t = leaf.triangle(used);
      expect(t < mesh_.triangle_count());
      std::atomic_ref(seen_[t]).store(1, std::memory_order_relaxed);
      const Triangle triangle = mesh_.triangle(t);
      fill(expected, used, t, triangle);
      for (const Vec3& corner : triangle) {
        low = low.cwiseMin(corner);
        high = high.cwiseMax(corner);
      }
    }
    expect(used > 0);
    for (std::size_t lane = used; lane < LeafBlock::lanes; ++lane) {
      for (auto& corner : expected.corner) {
        for (auto& axis : corner) axis[lane] = axis[0];
      }
      expected.source[lane] = no_triangle;
    }
    const Place place = places_[number];
    expect(std::memcmp(&leaf, &expected, sizeof leaf) == 0);
    expect(holds(nodes_[place.node], place.lane, low, high));
    return used;
  }

  static void fill(LeafBlock& leaf, std::size_t lane, TriangleId t, const Triangle& triangle) {
    const CornerOrder order = corner_order(triangle);
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3& corner = triangle[static_cast<std::size_t>(order.corner[c])];
      for (int axis = 0; axis < 3; ++axis) {
        leaf.corner[c][axis][lane] = static_cast<float>(corner[axis]);
      }
    }
    leaf.source[lane] = t | (order.odd ? LeafBlock::odd : 0);
  }

  const Mesh& mesh_;
  const BlockVector<NodeBlock>& nodes_;
  const BlockVector<LeafBlock>& leaves_;
  std::vector<std::uint8_t> levels_;  // of nodes, the root's 1; 0: not met yet
  std::vector<Place> places_;         // of leaves
  std::vector<std::uint8_t> seen_;    // triangles
};

double largest_rounding(const Mesh& mesh) {
  std::vector<double> errors(mesh.vertex_count() / share_size + 1, 0.0);
  share_ranges(mesh.vertex_count(), processors(), [&](std::size_t begin, std::size_t end) {
    double largest = 0.0;
    for (std::size_t v = begin; v < end; ++v) {
      const Vec3& vertex = mesh.vertex(static_cast<VertexId>(v));
      const double error = (vertex - vertex.cast<float>().cast<double>()).cwiseAbs().maxCoeff();
      largest = std::max(largest, error);
    }
    errors[begin / share_size] = largest;
  });
  return *std::max_element(errors.begin(), errors.end());
}

}  // namespace

WideBvh::WideBvh(std::shared_ptr<const Mesh> mesh, BlockVector<NodeBlock> nodes,
                 BlockVector<LeafBlock> leaves)
    : mesh_(std::move(mesh)), nodes_(std::move(nodes)), leaves_(std::move(leaves)) {
  expect(mesh_->triangle_count() <= most_triangles);
  Check(*mesh_, nodes_, leaves_).run();
  coordinate_error_ = largest_rounding(*mesh_);
  cylinders_.resize(nodes_.size());
  enclose_blocks();
}

/// Puts the cylinders around what the blocks hold.
void WideBvh::enclose_blocks() {
  share_ranges(nodes_.size(), processors(), [&](std::size_t begin, std::size_t end) {
    NodeBlock boxes;
    for (std::size_t n = begin; n < end; ++n) {
      SixteenLeaves leaves;
      leaves.fill(leaves_.data());  // where there is none
      for (std::size_t lane = 0; lane < NodeBlock::lanes; ++lane) {
        const std::uint32_t child = nodes_[n].child[lane];
        if ((child & NodeBlock::leaf) != 0) leaves[lane] = &leaves_[child & ~NodeBlock::leaf];
      }
      enclose(leaves, boxes, cylinders_[n]);
      for (std::size_t lane = 0; lane < NodeBlock::lanes; ++lane) {
        if ((nodes_[n].child[lane] & NodeBlock::leaf) == 0) close_lane(cylinders_[n], lane);
      }
    }
  });
  // A parent stands before its children.
  NodeBlock boxes;
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    for (std::size_t lane = 0; lane < NodeBlock::lanes && nodes_[n].is_used(lane); ++lane) {
      const std::uint32_t child = nodes_[n].child[lane];
      if ((child & NodeBlock::leaf) != 0) continue;
      enclose(nodes_[child], cylinders_[child], boxes, cylinders_[n], lane);
    }
  }
}

}  // namespace keepout
