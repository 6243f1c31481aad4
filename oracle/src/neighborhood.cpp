// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/oracle/neighborhood.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace keepout::oracle {
namespace {

const Bounds nowhere{Vec3::Constant(std::numeric_limits<double>::infinity()),
                     Vec3::Constant(-std::numeric_limits<double>::infinity())};

// To look through a neighbor takes some 2 ns, to fetch one some 50. Between these numbers the two
// costs are about even for steps along a fine mesh.
constexpr std::size_t few = 24;
constexpr std::size_t many = 96;
constexpr std::size_t group_size = 8;
constexpr double least_margin = 0.25;
constexpr double largest_margin = 16.0;

}  // namespace

Neighborhood::Neighborhood(std::shared_ptr<const TriangleTree> tree)
    : tree_(std::move(tree)), region_(nowhere) {}

void Neighborhood::fetch(const Bounds& box) {
  ++fetches_;
  region_ = inflated(box, margin_ * (box.high - box.low).maxCoeff());
  found_.clear();
  tree_->collect(region_, found_);
  neighbors_.clear();
  for (const TriangleId t : found_) {
    const Triangle triangle = tree_->mesh().triangle(t);
    neighbors_.push_back({bounds_of(triangle), triangle, t});
  }
  groups_.clear();
  for (std::size_t first = 0; first < neighbors_.size(); first += group_size) {
    const std::span<const Neighbor> all(neighbors_);
    const auto group = all.subspan(first, std::min(group_size, all.size() - first));
    Bounds bounds = group.front().bounds;
    for (const Neighbor& neighbor : group) bounds = united(bounds, neighbor.bounds);
    groups_.push_back({bounds, group});
  }
  // For the next time: neither too much to look through, nor too soon too little.
  if (found_.size() > many) margin_ = std::max(least_margin, 0.5 * margin_);
  if (found_.size() < few) margin_ = std::min(largest_margin, 2.0 * margin_);
}

}  // namespace keepout::oracle
