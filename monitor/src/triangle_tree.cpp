// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/monitor/triangle_tree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace keepout::monitor {
namespace {

constexpr std::size_t leaf_size = 4;
// Each level halves the triangles, so 2^32 triangles make 32 levels, with one waiting entry each.
constexpr std::size_t largest_depth = 40;

/// Returns the distance of a point from a box, with a relative error below 2^-50.
double distance_from(const Bounds& box, const Vec3& point) noexcept {
  return (box.low - point).cwiseMax(point - box.high).cwiseMax(Vec3::Zero()).norm();
}

/// True if a segment touches a box: its intervals between the three pairs of planes, as fractions
/// of its length, have a common value.
class TouchedBy {
 public:
  explicit TouchedBy(const Segment& segment)
      : from_(segment.from), inverse_((segment.to - segment.from).cwiseInverse()) {}

  bool operator()(const Bounds& box) const noexcept {
    const Vec3 one = (box.low - from_).cwiseProduct(inverse_);
    const Vec3 other = (box.high - from_).cwiseProduct(inverse_);
    const double enter = std::max(0.0, one.cwiseMin(other).maxCoeff());
    const double leave = std::min(1.0, one.cwiseMax(other).minCoeff());
    // Each fraction has the right sign, and a relative error of at most four roundings: 2^-51.
    return enter <= leave * (1.0 + 0x1p-48);
  }

 private:
  Vec3 from_;
  Vec3 inverse_;
};

/// True if the ball around a box comes within `reach` of a segment.
class WithinOf {
 public:
  WithinOf(double reach, const Segment& segment)
      : from_(segment.from), way_(segment.to - segment.from), reach_(reach) {
    const double squared = way_.squaredNorm();
    inverse_ = squared > 0.0 ? 1.0 / squared : 0.0;
  }

  bool operator()(const Bounds& box) const noexcept {
    const Vec3 center = 0.5 * box.low + 0.5 * box.high;
    const Vec3 offset = center - from_;
    const double along = std::clamp(offset.dot(way_) * inverse_, 0.0, 1.0);
    const double distance = (offset - along * way_).norm();
    // About ten roundings of the coordinates, and of the lengths: 2^-48 covers both.
    const double rounding = 0x1p-48 * (center.lpNorm<1>() + from_.lpNorm<1>() + way_.lpNorm<1>());
    return distance <= reach_ + 0.5 * (box.high - box.low).norm() + 4.0 * rounding;
  }

 private:
  Vec3 from_;
  Vec3 way_;
  double reach_;
  double inverse_;
};

}  // namespace

TriangleTree::TriangleTree(std::shared_ptr<const Mesh> mesh) : mesh_(std::move(mesh)) {
  std::vector<Item> items(mesh_->triangle_count());
  for (TriangleId t = 0; t < items.size(); ++t) {
    const Bounds bounds = bounds_of(mesh_->triangle(t));
    items[t] = {0.5 * bounds.low + 0.5 * bounds.high, t};
  }
  nodes_.reserve(items.size());
  order_.reserve(items.size());
  build(items, 0, items.size());
}

std::uint32_t TriangleTree::build(std::vector<Item>& items, std::size_t first, std::size_t count) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  if (count <= leaf_size) {
    Bounds bounds = bounds_of(mesh_->triangle(items[first].triangle));
    for (std::size_t i = first; i < first + count; ++i) {
      bounds = united(bounds, bounds_of(mesh_->triangle(items[i].triangle)));
      order_.push_back(items[i].triangle);
    }
    nodes_[index] = {bounds, 0, static_cast<std::uint32_t>(order_.size() - count),
                     static_cast<std::uint32_t>(count)};
    return index;
  }
  Bounds centers{items[first].center, items[first].center};
  for (std::size_t i = first; i < first + count; ++i) {
    centers = united(centers, {items[i].center, items[i].center});
  }
  int axis = 0;
  (centers.high - centers.low).maxCoeff(&axis);
  const std::size_t half = count / 2;
  const auto begin = items.begin() + static_cast<std::ptrdiff_t>(first);
  std::nth_element(
      begin, begin + static_cast<std::ptrdiff_t>(half), begin + static_cast<std::ptrdiff_t>(count),
      [axis](const Item& a, const Item& b) { return a.center[axis] < b.center[axis]; });
  const std::uint32_t one = build(items, first, half);
  const std::uint32_t other = build(items, first + half, count - half);
  nodes_[index] = {united(nodes_[one].bounds, nodes_[other].bounds), other, 0, 0};
  return index;
}

template <class Test>
bool TriangleTree::collect_where(const Test& test, std::vector<TriangleId>& out,
                                 const SearchLimit& limit) const {
  std::array<std::uint32_t, largest_depth> waiting{};
  std::size_t size = 0;
  waiting[size++] = 0;
  while (size > 0) {
    const std::uint32_t index = waiting[--size];
    const Node& node = nodes_[index];
    if (limit.work != nullptr) {
      if (*limit.work == 0) return false;
      --*limit.work;
    }
    if (!test(node.bounds)) continue;
    if (node.count > limit.triangles - out.size()) return false;
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      if (test(bounds_of(mesh_->triangle(order_[i])))) out.push_back(order_[i]);
    }
    if (node.count > 0) continue;
    waiting[size++] = node.next;
    waiting[size++] = index + 1;
  }
  return true;
}

void TriangleTree::collect(const Bounds& box, std::vector<TriangleId>& out) const {
  collect_where([&box](const Bounds& bounds) { return bounds.overlaps(box); }, out, {});
}

void TriangleTree::collect_along(const Segment& segment, std::vector<TriangleId>& out) const {
  collect_where(TouchedBy(segment), out, {});
}

bool TriangleTree::collect_within(double reach, const Segment& segment,
                                  std::vector<TriangleId>& out, const SearchLimit& limit) const {
  return collect_where(WithinOf(reach, segment), out, limit);
}

TriangleTree::Nearest TriangleTree::nearest(const Vec3& point, BracketFunction between) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Nearest best{no_triangle, {infinity, infinity, infinity}};
  double low = infinity;
  visit_nearest(0, {point, point}, between, best, low);
  best.distance.low = low;
  return best;
}

void TriangleTree::visit_nearest(std::uint32_t index, const Segment& point, BracketFunction between,
                                 Nearest& best, double& low) const {
  // Skipped triangles are farther than an examined one, and so farther than `low`.
  const auto may_be_nearer = [&best](double distance) {
    return distance * (1.0 - 0x1p-48) <= best.distance.high;
  };
  const Node& node = nodes_[index];
  for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
    const Triangle triangle = mesh_->triangle(order_[i]);
    if (!may_be_nearer(distance_from(bounds_of(triangle), point.from))) continue;
    const Bracket distance = between(point, triangle);
    low = std::min(low, distance.low);
    if (distance.estimate < best.distance.estimate || best.triangle == no_triangle) {
      best = {order_[i], distance};
    }
  }
  if (node.count > 0) return;
  std::array<std::uint32_t, 2> children{index + 1, node.next};
  std::array<double, 2> distances{distance_from(nodes_[children[0]].bounds, point.from),
                                  distance_from(nodes_[children[1]].bounds, point.from)};
  if (distances[1] < distances[0]) {
    std::swap(children[0], children[1]);
    std::swap(distances[0], distances[1]);
  }
  for (int i = 0; i < 2; ++i) {
    if (may_be_nearer(distances[i])) visit_nearest(children[i], point, between, best, low);
  }
}

}  // namespace keepout::monitor
