// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/oracle/safety_oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace keepout::oracle {
namespace {

const Bounds nowhere{Vec3::Constant(std::numeric_limits<double>::infinity()),
                     Vec3::Constant(-std::numeric_limits<double>::infinity())};

// Examining a neighbor takes about 2 ns, fetching one about 50 ns. Between these numbers, both
// costs are about equal for steps along a fine mesh.
constexpr std::size_t few = 24;
constexpr std::size_t many = 96;
constexpr std::size_t group_size = 8;
constexpr double least_margin = 0.25;
constexpr double largest_margin = 16.0;

void keep_nearer(Finding& finding, double distance, TriangleId triangle) noexcept {
  if (distance < finding.distance ||
      (distance == finding.distance && triangle < finding.triangle)) {
    finding.distance = distance;
    finding.triangle = triangle;
  }
}

}  // namespace

Neighborhood::Neighborhood(std::shared_ptr<const TriangleTree> tree)
    : tree_(std::move(tree)), region_(nowhere) {}

void Neighborhood::fetch(const Bounds& box) {
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
  // Adapts the margin of the next fetch: not too many to examine, and not too soon too few.
  if (found_.size() > many) margin_ = std::max(least_margin, 0.5 * margin_);
  if (found_.size() < few) margin_ = std::min(largest_margin, 2.0 * margin_);
}

SafetyOracle::SafetyOracle(std::shared_ptr<const Mesh> mesh)
    : tree_(std::make_shared<const TriangleTree>(std::move(mesh))),
      inside_test_(std::make_shared<const InsideTest>(tree_)),
      neighborhood_(tree_) {}

bool SafetyOracle::is_clear(const Segment& segment, double reach) const noexcept {
  // The ball is convex, so it contains the segment if it contains both ends. Fewer than 8 roundings
  // in all.
  const double farthest = std::sqrt(std::max((segment.from - clear_ball_.center).squaredNorm(),
                                             (segment.to - clear_ball_.center).squaredNorm()));
  return (farthest + reach) * (1.0 + 0x1p-48) < clear_ball_.radius;
}

Finding SafetyOracle::check(const Vec3& from, const Vec3& to, double threshold, double reach) {
  if (!from.allFinite() || !to.allFinite() || !std::isfinite(threshold) || threshold < 0.0 ||
      !std::isfinite(reach)) {
    throw std::invalid_argument(
        "the oracle judges finite segments, thresholds >= 0 and finite reaches");
  }
  reach = std::max(reach, threshold);
  const Segment segment{from, to};
  Finding finding;
  if (is_clear(segment, reach)) return finding;

  const Bounds box = inflated(bounds_of(segment), reach);
  const std::span<const Neighborhood::Group> groups = neighborhood_.around(box);
  if (groups.empty()) clear_ball_ = {to, tree_->nearest(to, narrow_distance).distance.low};

  undecided_.clear();
  for (const Neighborhood::Group& group : groups) {
    if (!group.bounds.overlaps(box)) continue;
    for (const Neighborhood::Neighbor& neighbor : group.neighbors) {
      if (!neighbor.bounds.overlaps(box)) continue;
      const Bracket bracket = bracket_distance(segment, neighbor.triangle);
      if (bracket.low > reach) continue;
      const bool below = bracket.high < threshold;
      finding.below = finding.below || below;
      if (bracket.low > 0.0 && bracket.narrow() && (below || bracket.low >= threshold)) {
        if (bracket.estimate <= reach) keep_nearer(finding, bracket.estimate, neighbor.id);
      } else {
        undecided_.push_back(&neighbor);
      }
    }
  }
  for (const Neighborhood::Neighbor* neighbor : undecided_) {
    const ExactDistance exact = exact_distance(segment, neighbor->triangle, threshold);
    const bool below = exact.against_threshold < 0;
    finding.crosses = finding.crosses || exact.against_zero == 0;
    finding.below = finding.below || below;
    // The root is rounded, but not across the threshold.
    const double distance =
        below ? std::min(exact.distance, threshold) : std::max(exact.distance, threshold);
    if (distance <= reach) keep_nearer(finding, distance, neighbor->id);
  }
  return finding;
}

double SafetyOracle::distance(const Vec3& point) const {
  return tree_->nearest(point, narrow_distance).distance.estimate;
}

}  // namespace keepout::oracle
