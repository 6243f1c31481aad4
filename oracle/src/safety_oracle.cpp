// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/oracle/safety_oracle.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace keepout::oracle {
namespace {

void keep_nearer(Finding& finding, double distance, TriangleId triangle) noexcept {
  if (distance < finding.distance ||
      (distance == finding.distance && triangle < finding.triangle)) {
    finding.distance = distance;
    finding.triangle = triangle;
  }
}

}  // namespace

SafetyOracle::SafetyOracle(std::shared_ptr<const Mesh> mesh)
    : tree_(std::make_shared<const TriangleTree>(std::move(mesh))),
      inside_test_(std::make_shared<const InsideTest>(tree_)),
      neighborhood_(tree_) {}

bool SafetyOracle::is_clear(const Segment& segment, double reach) const noexcept {
  // The ball is convex: with its ends the segment is in it. Less than 8 roundings in all.
  const double farthest = std::sqrt(std::max((segment.from - clear_ball_.center).squaredNorm(),
                                             (segment.to - clear_ball_.center).squaredNorm()));
  return (farthest + reach) * (1.0 + 0x1p-48) < clear_ball_.radius;
}

Finding SafetyOracle::check(const Vec3& from, const Vec3& to, double threshold, double reach) {
  if (!from.allFinite() || !to.allFinite() || !std::isfinite(threshold) || threshold < 0.0 ||
      !std::isfinite(reach)) {
    throw std::invalid_argument(
        "the oracle judges finite ways, thresholds >= 0 and finite reaches");
  }
  reach = std::max(reach, threshold);
  const Segment segment{from, to};
  Finding finding;
  if (is_clear(segment, reach)) return finding;

  const Bounds box = inflated(bounds_of(segment), reach);
  const std::span<const Neighborhood::Group> groups = neighborhood_.around(box);
  if (groups.empty()) clear_ball_ = {to, tree_->nearest(to).distance.low};

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
    ++exact_decisions_;
    const bool below = exact.against_threshold < 0;
    finding.crosses = finding.crosses || exact.against_zero == 0;
    finding.below = finding.below || below;
    // The root is rounded: not across the threshold.
    const double distance =
        below ? std::min(exact.distance, threshold) : std::max(exact.distance, threshold);
    if (distance <= reach) keep_nearer(finding, distance, neighbor->id);
  }
  return finding;
}

double SafetyOracle::distance(const Vec3& point) const {
  return tree_->nearest(point).distance.estimate;
}

}  // namespace keepout::oracle
