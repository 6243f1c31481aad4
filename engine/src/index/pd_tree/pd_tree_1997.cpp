// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/pd_tree_1997.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <span>
#include <utility>

#include "../tree_parts/median_split.h"
#include "keepout/error.h"
#include "keepout/geometry/closest_point.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

class PdTree1997::Builder {
 public:
  explicit Builder(PdTree1997& tree)
      : tree_(tree),
        mesh_(tree.mesh()),
        mean_levels_(2 * static_cast<std::size_t>(std::bit_width(mesh_.triangle_count()))) {}

  /// Builds a node and all nodes below it.
  void build(std::span<Center> centers, std::size_t level) {
    tree_.levels_ = std::max(tree_.levels_, level);
    const Spread spread = spread_of(centers);
    const std::size_t self = tree_.nodes_.size();
    tree_.nodes_.push_back(box_around(centers, principal_axes(spread.covariance)));
    if (centers.size() <= leaf_triangles) {
      tree_.nodes_[self].next = static_cast<std::uint32_t>(tree_.triangles_.size());
      tree_.nodes_[self].in_leaf = static_cast<std::uint32_t>(centers.size());
      for (const Center& center : centers) tree_.triangles_.push_back(center.triangle);
      return;
    }
    const std::size_t near = split(centers, spread.mean, tree_.nodes_[self].across.row(0), level);
    build(centers.first(near), level + 1);
    tree_.nodes_[self].next = static_cast<std::uint32_t>(tree_.nodes_.size());
    build(centers.subspan(near), level + 1);
  }

 private:
  Node box_around(std::span<const Center> centers, const Eigen::Matrix3d& across) const {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Node node{.across = across,
              .from = mesh_.triangle(centers.front().triangle)[0],
              .low = Vec3::Constant(infinity),
              .high = Vec3::Constant(-infinity),
              .next = 0};
    for (const Center& center : centers) {
      for (const Vec3& corner : mesh_.triangle(center.triangle)) {
        const Vec3 along = across * (corner - node.from);
        node.low = node.low.cwiseMin(along);
        node.high = node.high.cwiseMax(along);
      }
    }
    return node;
  }

  /// Splits the centers in two, and returns the number in the first part: at least one, and not
  /// all.
  std::size_t split(std::span<Center> centers, const Vec3& mean, const Vec3& direction,
                    std::size_t level) const {
    const auto along = [&](const Center& center) {
      const auto& [x, y, z] = center.position;
      return direction.dot(Vec3(double{x}, double{y}, double{z}) - mean);
    };
    if (level < mean_levels_) {
      const auto middle = std::partition(centers.begin(), centers.end(),
                                         [&](const Center& center) { return along(center) < 0.0; });
      if (middle != centers.begin() && middle != centers.end()) {
        return static_cast<std::size_t>(middle - centers.begin());
      }
    }
    const std::size_t half = centers.size() / 2;
    std::nth_element(centers.begin(), centers.begin() + static_cast<std::ptrdiff_t>(half),
                     centers.end(), [&](const Center& a, const Center& b) {
                       return std::pair(along(a), a.triangle) < std::pair(along(b), b.triangle);
                     });
    return half;
  }

  PdTree1997& tree_;
  const Mesh& mesh_;
  const std::size_t mean_levels_;
};

PdTree1997::PdTree1997(std::shared_ptr<const Mesh> mesh) : SpatialIndex(std::move(mesh)) {
  if (this->mesh().triangle_count() > most_triangles) {
    throw Error("a pd_tree_1997 holds at most 2^31 - 1 triangles: split or decimate the mesh");
  }
  triangles_.reserve(this->mesh().triangle_count());
  BlockVector<Center> centers = centers_of(this->mesh(), 1);
  Builder(*this).build(centers, 1);
  nodes_.shrink_to_fit();
}

void PdTree1997::collect(const Ball& ball, TriangleBuffer& candidates) const noexcept {
  const double reach = padded_radius(ball, mesh().bounds());
  std::array<std::uint32_t, most_levels> waiting;
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0 && !candidates.overflowed()) {
    const std::uint32_t at = waiting[--count];
    const Node& node = nodes_[at];
    const Vec3 along = node.across * (ball.center - node.from);
    if (squared_distance({node.low, node.high}, along) > reach * reach) continue;
    if (node.in_leaf == 0) {
      waiting[count++] = node.next;
      waiting[count++] = at + 1;
      continue;
    }
    for (std::uint32_t i = node.next; i < node.next + node.in_leaf; ++i) {
      const TriangleId t = triangles_[i];
      if (closest_point(mesh().triangle(t), ball.center).distance <= ball.radius) {
        candidates.push(t);
      }
    }
  }
}

std::size_t PdTree1997::memory() const noexcept {
  return nodes_.capacity() * sizeof(Node) + triangles_.capacity() * sizeof(TriangleId);
}

}  // namespace keepout
