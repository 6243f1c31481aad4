// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <utility>

#include "../../parallel.h"
#include "../tree_parts/leaf_fill.h"
#include "../tree_parts/median_split.h"
#include "keepout/error.h"
#include "tree.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "index/pd_tree/build.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which sets the target to compile for.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Computes the extents of leaves from `node.center` along three directions, exact to the rounding
/// of floats. They contain 0. [length]
void extent_of(const PdNode& node, std::span<const LeafBlock> leaves, float (&least)[3],
               float (&most)[3]) {
  const hn::CappedTag<float, LeafBlock::lanes> d;
  using Lanes = hn::Vec<decltype(d)>;
  Lanes low[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  Lanes high[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  for (const LeafBlock& leaf : leaves) {
    for (const auto& corner : leaf.corner) {
      for (std::size_t first = 0; first < LeafBlock::lanes; first += hn::Lanes(d)) {
        const Lanes x = hn::Sub(hn::Load(d, corner[0] + first), hn::Set(d, node.center[0]));
        const Lanes y = hn::Sub(hn::Load(d, corner[1] + first), hn::Set(d, node.center[1]));
        const Lanes z = hn::Sub(hn::Load(d, corner[2] + first), hn::Set(d, node.center[2]));
        for (std::size_t k = 0; k < 3; ++k) {
          const Lanes along = hn::Add(hn::Add(hn::Mul(x, hn::Set(d, node.across[0][k])),
                                              hn::Mul(y, hn::Set(d, node.across[1][k]))),
                                      hn::Mul(z, hn::Set(d, node.across[2][k])));
          low[k] = hn::Min(low[k], along);
          high[k] = hn::Max(high[k], along);
        }
      }
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    least[k] = hn::GetLane(hn::MinOfLanes(d, low[k]));
    most[k] = hn::GetLane(hn::MaxOfLanes(d, high[k]));
  }
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(extent_of);

namespace {

constexpr std::size_t worth_a_thread = 4096;  // triangles

class Builder {
 public:
  Builder(const Mesh& mesh, std::span<PdNode> nodes, std::span<LeafBlock> leaves)
      : mesh_(mesh), nodes_(nodes), leaves_(leaves) {}

  /// Builds the tree. Returns the frame of the leaves.
  LeafFrame build(unsigned threads) {
    {
      const LeafFill fill(mesh_, threads);
      frame_ = fill.frame();
      middle_ = mesh_.bounds().center() - frame_.origin;
      BlockVector<Center> centers = centers_of(mesh_, threads);
      BlockVector<Center> spare(centers.size());
      divide(centers, spare, 0, 0, threads);
      constexpr std::size_t share = 1024;  // leaves, worked on at a time
      share_ranges(leaves_.size(), threads, share, [&](std::size_t begin, std::size_t end) {
        fill.fill(leaves_.first(end), begin, end, &leaves_[begin]);
      });
    }
    enclose(0, 0, threads);
    return frame_;
  }

 private:
  using Centers = std::span<Center>;

  /// Orients the boxes of a node and of all nodes below it, and distributes their triangles to
  /// leaves.
  void divide(Centers centers, Centers spare, std::size_t self, std::size_t first_leaf,
              unsigned threads) {
    PdNode& node = nodes_[self];
    const Spread spread = spread_of(centers);
    const Eigen::Matrix3d axes = principal_axes(spread.covariance);
    for (int axis = 0; axis < 3; ++axis) {
      node.center[axis] = static_cast<float>(middle_[axis] + spread.mean[axis]);
      for (int k = 0; k < 3; ++k) node.across[axis][k] = static_cast<float>(axes(k, axis));
    }
    const std::size_t leaves = (centers.size() + LeafBlock::lanes - 1) / LeafBlock::lanes;
    node.leaves = static_cast<std::uint32_t>(leaves);
    if (leaves == 1) return name_triangles(centers, leaves_[first_leaf]);

    const std::size_t near = leaves / 2;
    const std::size_t middle = near * LeafBlock::lanes;
    if (centers.size() < worth_a_thread) threads = 1;
    split(centers, spare, middle, threads, node);
    run_both(
        threads,
        [&] {
          divide(spare.first(middle), centers.first(middle), self + 1, first_leaf, threads / 2);
        },
        [&] {
          divide(spare.subspan(middle), centers.subspan(middle), self + 2 * near, first_leaf + near,
                 threads - threads / 2);
        });
  }

  /// Splits along the direction of the largest spread.
  static void split(Centers from, Centers to, std::size_t middle, unsigned threads,
                    const PdNode& node) {
    const auto along = [x = node.across[0][0], y = node.across[1][0],
                        z = node.across[2][0]](const Center& center) {
      return x * center.position[0] + y * center.position[1] + z * center.position[2];
    };
    float low = along(from.front());
    float high = low;
    for (const Center& center : from) {
      const float at = along(center);
      low = std::min(low, at);
      high = std::max(high, at);
    }
    split_at(from, to, middle, low, high, threads, along);
  }

  /// Computes the sizes of the boxes of a node and of all nodes below it.
  void enclose(std::size_t self, std::size_t first_leaf, unsigned threads) {
    PdNode& node = nodes_[self];
    const std::span inside = leaves_.subspan(first_leaf, node.leaves);
    float low[3], high[3];
    HWY_DYNAMIC_DISPATCH(extent_of)(node, inside, low, high);
    // The middle of the extents is the better center, up to the rounding of its coordinates. The
    // shift of the extents that results is known exactly.
    Vec3 shift = Vec3::Zero();  // along the mesh's axes
    for (int axis = 0; axis < 3; ++axis) {
      double to_middle = 0.0;
      for (int k = 0; k < 3; ++k) {
        to_middle += 0.5 * (double{low[k]} + double{high[k]}) * double{node.across[axis][k]};
      }
      const auto moved = static_cast<float>(double{node.center[axis]} + to_middle);
      shift[axis] = double{moved} - double{node.center[axis]};
      node.center[axis] = moved;
    }
    double reach = 0.0;
    for (int k = 0; k < 3; ++k) reach += std::max(double{high[k]}, -double{low[k]});
    for (int k = 0; k < 3; ++k) {
      double along = 0.0;
      for (int axis = 0; axis < 3; ++axis) along += shift[axis] * double{node.across[axis][k]};
      const double half = std::max(double{high[k]} - along, along - double{low[k]});
      node.half[k] = static_cast<float>(half + outward * reach + 2.0 * frame_.error) + 1e-36f;
    }
    if (node.leaves == 1) return;
    const std::size_t near = node.leaves / 2;
    run_both(
        node.leaves * LeafBlock::lanes >= worth_a_thread ? threads : 1,
        [&] { enclose(self + 1, first_leaf, threads / 2); },
        [&] { enclose(self + 2 * near, first_leaf + near, threads - threads / 2); });
  }

  // The extents are off by 6 roundings of the farthest corner's distance. A query's position in the
  // box is off by 8 roundings of the box's size.
  static constexpr double outward = 64 * 0x1p-24;

  const Mesh& mesh_;
  LeafFrame frame_;
  Vec3 middle_;  // of the mesh's bounds, from the frame's origin; the centers are relative to it
                 // [length]
  std::span<PdNode> nodes_;
  std::span<LeafBlock> leaves_;
};

}  // namespace

static_assert(PdTree::most_triangles == LeafBlock::most_triangles);

PdTree::Tree::Tree(const PdTree& index, unsigned threads) : index_(index) {
  const std::size_t count = index.mesh().triangle_count();
  if (count > most_triangles) {
    throw Error("a pd_tree holds at most 2^31 - 1 triangles: split or decimate the mesh");
  }
  leaves_.resize((count + LeafBlock::lanes - 1) / LeafBlock::lanes);
  nodes_.resize(2 * leaves_.size() - 1);
  frame_ = Builder(index.mesh(), nodes_, leaves_).build(thread_count(threads));
}

std::size_t PdTree::Tree::memory() const noexcept {
  return nodes_.capacity() * sizeof(PdNode) + leaves_.capacity() * sizeof(LeafBlock);
}

PdTree::PdTree(std::shared_ptr<const Mesh> mesh, unsigned threads)
    : SpatialIndex(std::move(mesh)), tree_(std::make_unique<Tree>(*this, threads)) {}

PdTree::~PdTree() = default;

const TriangleBlocks* PdTree::blocks() const noexcept { return tree_.get(); }

double PdTree::rounding() const noexcept { return tree_->frame().error; }

std::size_t PdTree::memory() const noexcept { return tree_->memory(); }

}  // namespace keepout

#endif  // HWY_ONCE
