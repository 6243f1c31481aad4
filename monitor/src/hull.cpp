// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/monitor/hull.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace keepout::monitor {
namespace {

// A fraction of the cube of the hull's size: a smaller volume is treated as flat.
constexpr double flat = 1e-10;

double cubed(double x) noexcept { return x * x * x; }

/// Returns the vector from a point to the nearest point of a segment.
Vec3 way_to(const Vec3& from, const Vec3& to, const Vec3& point) noexcept {
  const Vec3 way = to - from;
  const Vec3 offset = point - from;
  const double squared = way.squaredNorm();
  const double along = squared > 0.0 ? std::clamp(offset.dot(way) / squared, 0.0, 1.0) : 0.0;
  return along * way - offset;
}

/// Returns the least and the largest signed volume, times six, of the tetrahedra of points and a
/// triangle.
std::array<double, 2> volumes(std::span<const Vec3> points, const Vec3& a, const Vec3& b,
                              const Vec3& c) noexcept {
  const Vec3 normal = (b - a).cross(c - a);
  std::array<double, 2> range{0.0, 0.0};
  for (const Vec3& p : points) {
    const double volume = normal.dot(p - a);
    range = {std::min(range[0], volume), std::max(range[1], volume)};
  }
  return range;
}

}  // namespace

Hull::Hull(std::span<const Vec3> points) {
  if (points.empty() || points.size() > most_points) {
    throw std::invalid_argument("a hull has 1 to 64 points");
  }
  move_to(points);
  const auto n = static_cast<std::uint8_t>(points.size());
  if (n < 3) {
    edges_.push_back({0, static_cast<std::uint8_t>(n - 1)});
    return;
  }
  const double nothing = flat * cubed(radius_);
  std::array<std::array<bool, most_points>, most_points> is_edge{};
  for (std::uint8_t i = 0; i < n; ++i) {
    for (std::uint8_t j = i + 1; j < n; ++j) {
      for (std::uint8_t k = j + 1; k < n; ++k) {
        const auto [least, most] = volumes(points_, points_[i], points_[j], points_[k]);
        if (least < -nothing && most > nothing) continue;  // points are on both sides
        faces_.push_back({i, j, k});
        is_edge[i][j] = is_edge[j][k] = is_edge[i][k] = true;
      }
    }
  }
  for (std::uint8_t i = 0; i < n; ++i) {
    for (std::uint8_t j = i + 1; j < n; ++j) {
      if (is_edge[i][j]) edges_.push_back({i, j});
    }
  }
}

void Hull::move_to(std::span<const Vec3> points) {
  points_.assign(points.begin(), points.end());
  center_.setZero();
  for (const Vec3& p : points_) center_ += p / static_cast<double>(points_.size());
  radius_ = 0.0;
  for (const Vec3& p : points_) radius_ = std::max(radius_, (p - center_).norm());
}

double Hull::least_distance(const Vec3& point) const noexcept {
  if (points_.size() < 3) return way_to(points_.front(), points_.back(), point).norm();
  const Vec3 towards = center_ - point;
  const double length = towards.norm();
  if (!(length > 0.0)) return 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& p : points_) least = std::min(least, towards.dot(p - point) / length);
  return std::max({0.0, least, length - radius_});
}

Vec3 Hull::way_from(const Vec3& point) const noexcept {
  if (points_.size() < 3) return way_to(points_.front(), points_.back(), point);
  return center_ - point;
}

bool Hull::contains(const Vec3& point) const noexcept {
  const double nothing = flat * cubed(radius_);
  bool is_solid = false;
  for (const auto& [i, j, k] : faces_) {
    const Vec3& a = points_[i];
    const auto [least, most] = volumes(points_, a, points_[j], points_[k]);
    if (least >= -nothing && most <= nothing) continue;  // flat, or not a face
    is_solid = true;
    const double volume = (points_[j] - a).cross(points_[k] - a).dot(point - a);
    const bool is_beyond = most > nothing ? volume <= 0.0 : volume >= 0.0;
    if (is_beyond) return false;
  }
  return is_solid;
}

/// Returns a vector from triangle to hull that is about the shortest, by a few steps towards the
/// difference of least norm. Source: Frank, Wolfe, "An algorithm for quadratic programming", 1956.
Vec3 Hull::direction_from(const Triangle& triangle) const noexcept {
  constexpr int steps = 12;
  Vec3 way = points_[0] - triangle[0];
  for (int i = 0; i < steps; ++i) {
    const auto lower = [&](const Vec3& a, const Vec3& b) { return way.dot(a) < way.dot(b); };
    const Vec3 corner = *std::min_element(points_.begin(), points_.end(), lower) -
                        *std::max_element(triangle.begin(), triangle.end(), lower);
    const Vec3 step = corner - way;
    const double gain = -way.dot(step);
    if (!(gain > 1e-12 * way.squaredNorm())) break;
    way += std::min(gain / step.squaredNorm(), 1.0) * step;
  }
  return way;
}

/// Returns the least of the brackets that `between` returns for a segment, a triangle, and whether
/// the segment is one of the hull.
template <class Between>
Bracket Hull::least(const Triangle& triangle, double enough, const Between& between) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec3 along = direction_from(triangle);
  const double length = along.norm();
  along = length > 0.0 ? Vec3(along / length) : Vec3::Zero();
  // Heights over the hull's center have an error of about ten roundings of the lengths.
  std::array<double, most_points> heights{};
  std::array<double, 3> of_corners{};
  double size = radius_;
  for (std::size_t c = 0; c < 3; ++c) {
    of_corners[c] = along.dot(triangle[c] - center_);
    size = std::max(size, (triangle[c] - center_).norm());
  }
  const double rounding = 0x1p-46 * (size + center_.lpNorm<1>());
  double lowest = infinity;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    heights[i] = along.dot(points_[i] - center_) - rounding;
    lowest = std::min(lowest, heights[i]);
  }
  const double highest = *std::max_element(of_corners.begin(), of_corners.end());
  if (lowest - highest > enough) return {lowest - highest, length, length + rounding};

  double high = length + rounding;
  Bracket least{infinity, infinity, infinity};
  const auto take = [&](const Segment& segment, const Triangle& other, bool is_of_hull) {
    const Bracket of = between(segment, other, is_of_hull);
    least = {std::min(least.low, of.low), std::min(least.estimate, of.estimate),
             std::min(least.high, of.high)};
    high = std::min(high, of.high);
  };
  for (const auto& [i, j] : edges_) {
    if (std::min(heights[i], heights[j]) - highest > high) continue;
    take({points_[i], points_[j]}, triangle, true);
    if (high == 0.0) return least;
  }
  for (const auto& [i, j, k] : faces_) {
    const double low = std::min({heights[i], heights[j], heights[k]});
    for (std::size_t e = 0; e < 3; ++e) {
      if (low - std::max(of_corners[e], of_corners[(e + 1) % 3]) > high) continue;
      take({triangle[e], triangle[(e + 1) % 3]}, {points_[i], points_[j], points_[k]}, false);
      if (high == 0.0) return least;
    }
  }
  if (contains(triangle[0])) return {0.0, 0.0, 0.0};
  return least;
}

Bracket Hull::distance(const Triangle& triangle, BracketFunction between, double enough) const {
  return least(triangle, enough, [between](const Segment& segment, const Triangle& other, bool) {
    return between(segment, other);
  });
}

Gap Hull::gap(const Triangle& triangle) const noexcept {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (points_.size() < 3) return gap_between({points_.front(), points_.back()}, triangle);
  Gap nearest{{infinity, infinity, infinity}, Vec3::Zero()};
  const auto between = [&nearest](const Segment& segment, const Triangle& other, bool is_of_hull) {
    const Gap gap = gap_between(segment, other);
    if (gap.distance.estimate < nearest.distance.estimate) {
      nearest = {gap.distance, is_of_hull ? gap.direction : Vec3(-gap.direction)};
    }
    return gap.distance;
  };
  nearest.distance = least(triangle, infinity, between);
  return nearest;
}

}  // namespace keepout::monitor
