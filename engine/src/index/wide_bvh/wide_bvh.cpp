// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/wide_bvh.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <utility>

#include "../../parallel.h"
#include "keepout/error.h"
#include "keepout/rounding_mode.h"
#include "traversal/tree_traversal.h"
#include "tree.h"

namespace keepout {

WideBvh::WideBvh(std::shared_ptr<const Mesh> mesh, unsigned threads)
    : SpatialIndex(std::move(mesh)), tree_(std::make_unique<Tree>(*this)) {
  threads = thread_count(threads);
  tree_->divide(threads);
  tree_->fit(LeafFill(this->mesh(), threads), threads);
}

WideBvh::WideBvh(std::shared_ptr<const Mesh> mesh, std::span<const TriangleId> order,
                 unsigned threads)
    : SpatialIndex(std::move(mesh)) {
  const std::size_t count = this->mesh().triangle_count();
  threads = thread_count(threads);
  std::vector<std::uint8_t> named(count);
  std::atomic<bool> known = order.size() == count;
  share_ranges(known ? count : 0, threads, [&](std::size_t begin, std::size_t end) {
    for (const TriangleId t : order.subspan(begin, end - begin)) {
      if (t >= count) {
        known = false;
      } else {
        std::atomic_ref(named[t]).store(1, std::memory_order_relaxed);
      }
    }
  });
  // The order has the right length and names every triangle, so it names none twice.
  if (!known || std::ranges::find(named, 0) != named.end()) {
    throw Error("the order of a wide_bvh must name each triangle of the mesh exactly once");
  }
  tree_ = std::make_unique<Tree>(*this);
  tree_->divide(order);
  tree_->fit(LeafFill(this->mesh(), threads), threads);
}

WideBvh::~WideBvh() = default;

std::vector<TriangleId> WideBvh::order() const {
  std::vector<TriangleId> order;
  order.reserve(mesh().triangle_count());
  for (const LeafBlock& leaf : tree_->leaves()) {
    for (std::size_t lane = 0; lane < LeafBlock::lanes && leaf.is_used(lane); ++lane) {
      order.push_back(leaf.triangle(lane));
    }
  }
  return order;
}

std::unique_ptr<SpatialIndex> WideBvh::refitted(std::shared_ptr<const Mesh> moved) const {
  require_same_triangles(moved.get(), thread_count(0));
  return std::make_unique<WideBvh>(std::move(moved), order());
}

void WideBvh::require_same_triangles(const Mesh* moved, unsigned threads) const {
  if (moved == nullptr) throw Error("a refit needs a mesh, but it is null");
  const auto corners = mesh().triangles();
  const auto others = moved->triangles();
  std::atomic<bool> same =
      corners.size() == others.size() && mesh().vertex_count() == moved->vertex_count();
  share_ranges(same ? corners.size() : 0, threads, [&](std::size_t begin, std::size_t end) {
    const std::size_t bytes = (end - begin) * sizeof(Corners);
    if (std::memcmp(&corners[begin], &others[begin], bytes) != 0) same = false;
  });
  if (!same) throw Error("a refit is for moved vertices: the triangles must be the same");
}

void WideBvh::refit(std::shared_ptr<const Mesh> moved, unsigned threads) {
  require_rounding_to_nearest();
  threads = thread_count(threads);
  require_same_triangles(moved.get(), threads);
  const LeafFill fill(*moved, threads);
  tree_->collect_vertices(threads);
  set_mesh(std::move(moved));
  tree_->fit(fill, threads);
}

const TriangleBlocks* WideBvh::blocks() const noexcept { return tree_.get(); }

double WideBvh::rounding() const noexcept { return tree_->frame().error; }

std::size_t WideBvh::memory() const noexcept { return tree_->memory(); }

std::unique_ptr<MotionTraversal> WideBvh::traverse_along_motions(Budget& budget) const {
  return std::make_unique<TreeTraversal>(*tree_, budget);
}

}  // namespace keepout
