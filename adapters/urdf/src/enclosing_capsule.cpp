// SPDX-License-Identifier: BSD-3-Clause
#include "enclosing_capsule.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace keepout {
namespace {

constexpr int rounds_to_center = 64;
constexpr int radii_tried = 32;

/// A point relative to a line: its place along the line, and its distance from it.
struct OnLine {
  double along, off;
};

double volume(double radius, double length) {
  return std::numbers::pi * radius * radius * (length + 4.0 / 3.0 * radius);
}

/// Returns nearly the center of the least circle around the points, seen along an axis. Source:
/// Badoiu and Clarkson, "Smaller core-sets for balls", 2003: steps to the farthest point that get
/// shorter.
Vec3 center_across(std::span<const Vec3> points, const Vec3& axis) {
  const auto across = [&](const Vec3& point) { return Vec3(point - axis.dot(point) * axis); };
  Vec3 low = across(points.front()), high = low;
  for (const Vec3& point : points) {
    low = low.cwiseMin(across(point));
    high = high.cwiseMax(across(point));
  }
  Vec3 center = across(0.5 * (low + high));
  for (int round = 2; round <= rounds_to_center; ++round) {
    const auto farthest = std::ranges::max_element(
        points, {}, [&](const Vec3& point) { return (across(point) - center).squaredNorm(); });
    center += (across(*farthest) - center) / round;
  }
  return center;
}

/// Returns the capsule of least volume along an axis, of those that are tried, without rounding up.
/// `axis`: unit.
Capsule capsule_along(std::span<const Vec3> points, const Vec3& axis) {
  const Vec3 center = center_across(points, axis);
  std::vector<OnLine> places;
  double least = 0.0, low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Vec3& point : points) {
    const double along = axis.dot(point - center);
    places.push_back({along, (point - center - along * axis).norm()});
    least = std::max(least, places.back().off);
    low = std::min(low, along);
    high = std::max(high, along);
  }
  // With the radius of a ball around all points, the segment has no length.
  double most = least;
  for (const OnLine& at : places)
    most = std::max(most, std::hypot(at.along - 0.5 * (low + high), at.off));
  Capsule best{center, center, std::numeric_limits<double>::infinity()};
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= radii_tried; ++i) {
    const double radius = least + (most - least) * i / radii_tried;
    // The segment must have a point in the ball of this radius around each of the points.
    double from = std::numeric_limits<double>::infinity(), to = -from;
    for (const OnLine& at : places) {
      const double half = std::sqrt(std::max(0.0, radius * radius - at.off * at.off));
      from = std::min(from, at.along + half);
      to = std::max(to, at.along - half);
    }
    if (from > to) from = to = 0.5 * (from + to);
    if (!(volume(radius, to - from) < smallest)) continue;
    smallest = volume(radius, to - from);
    best = {center + from * axis, center + to * axis, radius};
  }
  return best;
}

/// Returns the distance of a point from a point of the segment, which is nearly the nearest one.
double distance(const Capsule& capsule, const Vec3& point) {
  const Vec3 way = capsule.to - capsule.from;
  const double length2 = way.squaredNorm();
  const double share =
      length2 > 0.0 ? std::clamp((point - capsule.from).dot(way) / length2, 0.0, 1.0) : 0.0;
  return (point - capsule.from - share * way).norm();
}

}  // namespace

Capsule enclosing_capsule(std::span<const Vec3> points) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& point : points) mean += point / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vec3& point : points) spread += (point - mean) * (point - mean).transpose();
  std::vector<Vec3> axes{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(spread);
  if (principal.info() == Eigen::Success) {
    for (int k = 0; k < 3; ++k) axes.push_back(principal.eigenvectors().col(k).normalized());
  }
  Capsule best{mean, mean, std::numeric_limits<double>::infinity()};
  for (const Vec3& axis : axes) {
    const Capsule one = capsule_along(points, axis);
    const auto size = [](const Capsule& c) { return volume(c.radius, (c.to - c.from).norm()); };
    if (size(one) < size(best)) best = one;
  }
  // The proof of the enclosure does not depend on the search: the radius follows from all
  // distances.
  double farthest = 0.0, size = 0.0;
  for (const Vec3& point : points) {
    farthest = std::max(farthest, distance(best, point));
    size = std::max(size, point.norm());
  }
  best.radius = farthest + outwards * (farthest + size);
  return best;
}

}  // namespace keepout
