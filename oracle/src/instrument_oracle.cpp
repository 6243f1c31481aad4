// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/oracle/instrument_oracle.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

namespace keepout::oracle {
namespace {

// What is fetched at once: neither so much that it takes long, nor so little that it is soon again.
constexpr std::size_t few = 64;
constexpr std::size_t many = 256;
constexpr double least_slack = 1.0 / 64.0;
constexpr double largest_slack = 16.0;

double distance_of(const Vec3& point, const Segment& segment) noexcept {
  const Vec3 way = segment.to - segment.from;
  const Vec3 offset = point - segment.from;
  const double squared = way.squaredNorm();
  const double along = squared > 0.0 ? std::clamp(offset.dot(way) / squared, 0.0, 1.0) : 0.0;
  return (offset - along * way).norm();
}

/// More than rounding can do to a distance between such places. [length]
double rounding_of(const Segment& segment, const Vec3& point) noexcept {
  return 0x1p-46 * (segment.from.lpNorm<1>() + segment.to.lpNorm<1>() + point.lpNorm<1>());
}

}  // namespace

InstrumentOracle::InstrumentOracle(std::shared_ptr<const TriangleTree> tree, JudgedRobot robot,
                                   const Pose& base)
    : tree_(std::move(tree)),
      robot_(std::move(robot)),
      base_(base),
      axes_(robot_.bodies.size()),
      surroundings_(robot_.bodies.size()) {}

void InstrumentOracle::move_to(std::span<const double> positions) {
  place(robot_, base_, positions, axes_);
}

void InstrumentOracle::move_to(std::span<const double> positions, const Pose& base) {
  base_ = base;
  move_to(positions);
}

void InstrumentOracle::look_around(Surroundings& around, const Segment& axis, double reach) {
  around.travelled = 0.0;
  around.known = reach + around.slack;
  found_.clear();
  tree_->collect_within(around.known, axis, found_);
  around.neighbors.clear();
  around.heap.clear();
  for (const TriangleId t : found_) {
    const Triangle triangle = tree_->mesh().triangle(t);
    const Bounds bounds = bounds_of(triangle);
    const Vec3 center = 0.5 * bounds.low + 0.5 * bounds.high;
    const double radius = std::max({(triangle[0] - center).norm(), (triangle[1] - center).norm(),
                                    (triangle[2] - center).norm()}) +
                          rounding_of(axis, center);
    const double low = distance_of(center, axis) - radius;
    if (low > around.known) continue;
    around.heap.push_back({low, static_cast<std::uint32_t>(around.neighbors.size())});
    around.neighbors.push_back({triangle, center, radius});
  }
  std::ranges::make_heap(around.heap, std::greater(), &Entry::key);
  const std::size_t count = around.neighbors.size();
  if (count > many) around.slack = std::max(least_slack, 0.5 * around.slack);
  if (count < few) around.slack = std::min(largest_slack, 2.0 * around.slack);
}

double InstrumentOracle::clearance(std::size_t body, double reach) {
  const Segment& axis = axes_[body];
  const double radius = robot_.bodies[body].radius;
  double nearest = reach + radius;
  bool found = false;
  Surroundings& around = surroundings_[body];
  // No point of the axis has moved farther than its farther end, nor has any distance changed more.
  around.travelled +=
      std::max((axis.from - around.last.from).norm(), (axis.to - around.last.to).norm()) +
      rounding_of(axis, around.last.to);
  around.last = axis;
  if (!(nearest + around.travelled < around.known)) look_around(around, axis, nearest);
  std::vector<Entry>& heap = around.heap;
  auto end = heap.end();  // of the heap; behind it is what was looked at by now
  while (end != heap.begin() && heap.front().key - around.travelled <= nearest) {
    std::ranges::pop_heap(heap.begin(), end, std::greater(), &Entry::key);
    Entry& entry = *--end;
    const Neighbor& neighbor = around.neighbors[entry.neighbor];
    double low = distance_of(neighbor.center, axis) - neighbor.radius;
    if (low <= nearest) {
      const Bracket distance = narrow_distance(axis, neighbor.triangle);
      low = distance.low;
      found = found || distance.estimate <= nearest;
      nearest = std::min(nearest, distance.estimate);
    }
    entry.key = low + around.travelled;
  }
  while (end != heap.end()) {
    std::ranges::push_heap(heap.begin(), ++end, std::greater(), &Entry::key);
  }
  return found ? nearest - radius : std::numeric_limits<double>::infinity();
}

}  // namespace keepout::oracle
