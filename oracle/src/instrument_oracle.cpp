// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/oracle/instrument_oracle.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <utility>

namespace keepout::oracle {
namespace {

// The number of triangles to fetch at once. More would take long, fewer would soon be too few.
constexpr std::size_t few = 64;
constexpr std::size_t many = 256;
constexpr double least_slack = 1.0 / 64.0;
constexpr double largest_slack = 16.0;

/// Returns a bound of the rounding error of a distance between a core and a point. [length]
double rounding_of(const Hull& core, const Vec3& point) noexcept {
  return 0x1p-46 * (core.center().lpNorm<1>() + core.radius() + point.lpNorm<1>());
}

/// Returns the largest displacement of all points of a core, which is that of a corner. [length]
double moved(std::span<const Vec3> from, std::span<const Vec3> to) noexcept {
  double most = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) most = std::max(most, (to[i] - from[i]).norm());
  return most;
}

}  // namespace

InstrumentOracle::InstrumentOracle(std::shared_ptr<const TriangleTree> tree, JudgedRobot robot,
                                   const Pose& base)
    : tree_(std::move(tree)),
      robot_(std::move(robot)),
      base_(base),
      surroundings_(robot_.bodies.size()) {
  for (const JudgedBody& body : robot_.bodies) {
    std::vector<Vec3> points;
    for (const JudgedPoint& point : body.points) points.push_back(point.position);
    cores_.emplace_back(points);
  }
}

void InstrumentOracle::move_to(std::span<const double> positions) {
  links_ = place(robot_, base_, positions);
  for (std::size_t b = 0; b < cores_.size(); ++b) {
    std::array<Vec3, Hull::most_points> points;
    const std::vector<JudgedPoint>& judged = robot_.bodies[b].points;
    for (std::size_t i = 0; i < judged.size(); ++i) {
      points[i] = links_[static_cast<std::size_t>(judged[i].link)].at(judged[i].position);
    }
    cores_[b].move_to({points.data(), judged.size()});
  }
}

void InstrumentOracle::move_to(std::span<const double> positions, const Pose& base) {
  base_ = base;
  move_to(positions);
}

void InstrumentOracle::look_around(Surroundings& around, const Hull& core, double reach) {
  around.travelled = 0.0;
  around.known = reach + around.slack;
  found_.clear();
  const bool is_segment = core.points().size() < 3;
  const Segment middle = is_segment ? Segment{core.points().front(), core.points().back()}
                                    : Segment{core.center(), core.center()};
  tree_->collect_within(around.known + (is_segment ? 0.0 : core.radius()), middle, found_);
  around.neighbors.clear();
  around.heap.clear();
  for (const TriangleId t : found_) {
    const Triangle triangle = tree_->mesh().triangle(t);
    const Bounds bounds = bounds_of(triangle);
    const Vec3 center = 0.5 * bounds.low + 0.5 * bounds.high;
    const double radius = std::max({(triangle[0] - center).norm(), (triangle[1] - center).norm(),
                                    (triangle[2] - center).norm()}) +
                          rounding_of(core, center);
    const double low = core.least_distance(center) - radius;
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
  const Hull& core = cores_[body];
  const double radius = robot_.bodies[body].radius;
  double nearest = reach + radius;
  bool found = false;
  Surroundings& around = surroundings_[body];
  // No point of the core has moved farther than a corner, and no distance has changed by more.
  if (around.last.empty()) around.last.assign(core.points().begin(), core.points().end());
  around.travelled += moved(around.last, core.points()) + rounding_of(core, around.last.front());
  around.last.assign(core.points().begin(), core.points().end());
  if (!(nearest + around.travelled < around.known)) look_around(around, core, nearest);
  std::vector<Entry>& heap = around.heap;
  auto end = heap.end();  // of the heap; the entries behind it were examined
  // A distance that is smaller by less than a billionth does not matter.
  const auto matters = [&](double low) { return low < nearest * (1.0 - 0.5e-9); };
  while (end != heap.begin() && matters(heap.front().key - around.travelled)) {
    std::ranges::pop_heap(heap.begin(), end, std::greater(), &Entry::key);
    Entry& entry = *--end;
    const Neighbor& neighbor = around.neighbors[entry.neighbor];
    double low = core.least_distance(neighbor.center) - neighbor.radius;
    if (matters(low)) {
      const Bracket distance = core.distance(neighbor.triangle, narrow_distance, nearest);
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
