// SPDX-License-Identifier: BSD-3-Clause

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "keepout/monitor/distance.h"

namespace keepout::monitor {
namespace {

// All positions are relative to the segment's start, so an offset of the world costs one rounding
// of each coordinate difference. Let u = 2^-53 and S the size. A coordinate difference has a
// relative error of u (a subtraction does not underflow).
//
// high = |x - y| with x = s d and y = w0 x0 + w1 x1 + w2 x2. The weights are >= 0 and sum to 1
// within 2 u (they are one or two subtractions from 1). Point x is off by 2 u S (difference,
// product). Point y is off by 4 u S (difference, product, two sums), and by 2 u S because it may be
// off the triangle. The length |x - y| <= 2 S gets 2 u S from the subtraction, and up to 3 u
// relative, 6 u S, from squares, sums and root. The sum is 16 u S.
//
// low = (min(0, n . d) - max n . x_i) / |n|. Each of the two products n . x is off by 4 u |n| S
// (difference, product, two sums). The rounding of their difference, at most 2 |n| S, is 2 u |n| S.
// |n| is accurate to 3 u and the quotient to 1 u: 8 u S. The sum is 18 u S.
//
// 2^-48 = 32 u also covers the terms in u^2 and the rounding of S. Underflow adds at most about
// 2^-1074 to a product, which is negligible because S >= 1e-70 and n^2 >= 1e-290 are required.
constexpr double rounding = 0x1p-48;
constexpr double least_size = 1e-70;
constexpr double largest_size = 1e70;
constexpr double least_squared_normal = 1e-290;

/// The nearest pair so far: x = along * way, y = the weighted sum of the corners.
struct Pair {
  double squared = std::numeric_limits<double>::infinity();
  double along = 0.0;
  Vec3 weights = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  // towards the segment, of any length

  void keep_nearer(const Pair& other) noexcept {
    if (other.squared < squared) *this = other;
  }
};

/// Returns the parameter of the foot of `point` on the line from the origin along `way`, clamped to
/// 0 .. 1. Returns 0 for a segment of length 0.
double foot(const Vec3& point, const Vec3& way, double squared_way) noexcept {
  const double along = point.dot(way);
  if (!(along > 0.0)) return 0.0;
  return along < squared_way ? along / squared_way : 1.0;
}

/// Returns `offset` after a second projection. The offset is perpendicular to `way` up to rounding,
/// which is large if the offset is short. The second projection leaves only the rounding of the
/// offset itself (Kahan: twice is enough).
Vec3 straightened(const Vec3& offset, const Vec3& way, double squared_way, double parameter) {
  if (parameter == 0.0 || parameter == 1.0) return offset;
  return offset - offset.dot(way) / squared_way * way;
}

Vec3 edge_weights(int edge, double along) noexcept {
  Vec3 weights = Vec3::Zero();
  weights[edge] = 1.0 - along;
  weights[(edge + 1) % 3] = along;
  return weights;
}

/// The triangle relative to the segment's start, and the vector along the segment.
struct Scene {
  std::array<Vec3, 3> corners;
  Vec3 way;
  double squared_way;

  Pair corner_to_way(int i) const noexcept {
    const double s = foot(corners[i], way, squared_way);
    const Vec3 offset = straightened(s * way - corners[i], way, squared_way, s);
    return {offset.squaredNorm(), s, Vec3::Unit(i), offset};
  }

  /// Returns the nearest pair of the segment and edge i: at an end of the segment, or at the common
  /// perpendicular.
  Pair edge_to_way(int i) const noexcept {
    const Vec3& corner = corners[i];
    const Vec3 side = corners[(i + 1) % 3] - corner;
    const double squared_side = side.squaredNorm();
    Pair best;
    for (const double s : {0.0, 1.0}) {
      const Vec3 point = s * way - corner;
      const double t = foot(point, side, squared_side);
      const Vec3 offset = straightened(point - t * side, side, squared_side, t);
      best.keep_nearer({offset.squaredNorm(), s, edge_weights(i, t), offset});
    }
    const Vec3 common = way.cross(side);
    const double common2 = common.squaredNorm();
    if (common2 > 0.0) {
      const double s = corner.cross(side).dot(common) / common2;
      const double t = corner.cross(way).dot(common) / common2;
      if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0) {
        const double height = corner.dot(common);
        best.keep_nearer(
            {height * height / common2, s, edge_weights(i, t), height < 0.0 ? common : -common});
      }
    }
    return best;
  }

  /// Returns the nearest pair of the face and an end of the segment, or the point where the segment
  /// pierces the face.
  Pair face_to_way() const noexcept {
    const Vec3 u = corners[1] - corners[0];
    const Vec3 v = corners[2] - corners[0];
    const Vec3 normal = u.cross(v);
    const double normal2 = normal.squaredNorm();
    Pair best;
    if (!(normal2 > 0.0)) return best;
    const double start = -normal.dot(corners[0]);
    const double end = normal.dot(way) + start;
    const bool pierces = (start < 0.0) != (end < 0.0);
    for (const double s : {0.0, 1.0, pierces ? start / (start - end) : 0.0}) {
      const Vec3 point = s * way - corners[0];
      const double b = point.cross(v).dot(normal) / normal2;
      const double c = u.cross(point).dot(normal) / normal2;
      const double a = 1.0 - b - c;
      if (!(a >= 0.0 && b >= 0.0 && c >= 0.0)) continue;
      const double height = s == 0.0 ? start : s == 1.0 ? end : 0.0;
      best.keep_nearer(
          {height * height / normal2, s, Vec3(a, b, c), height < 0.0 ? -normal : normal});
    }
    return best;
  }
};

double one_norm(const Vec3& v) noexcept { return v.lpNorm<1>(); }

/// Returns the separation of segment and triangle along the direction, or 0 for an unusable
/// direction.
double separation(const Scene& scene, const Vec3& normal) noexcept {
  const double squared = normal.squaredNorm();
  if (!(squared >= least_squared_normal && squared <= 1.0 / least_squared_normal)) return 0.0;
  const double segment = std::min(0.0, normal.dot(scene.way));
  const double triangle = std::max(
      {normal.dot(scene.corners[0]), normal.dot(scene.corners[1]), normal.dot(scene.corners[2])});
  return (segment - triangle) / std::sqrt(squared);
}

}  // namespace

Gap gap_between(const Segment& segment, const Triangle& triangle) noexcept {
  Scene scene{{triangle[0] - segment.from, triangle[1] - segment.from, triangle[2] - segment.from},
              segment.to - segment.from,
              0.0};
  scene.squared_way = scene.way.squaredNorm();
  const double size = std::max({one_norm(scene.corners[0]), one_norm(scene.corners[1]),
                                one_norm(scene.corners[2]), one_norm(scene.way)});
  if (size == 0.0)
    return {{0.0, 0.0, 0.0}, Vec3::Zero()};  // doubles differ by 0 only if they are equal
  if (!(size >= least_size && size <= largest_size)) {
    return {{0.0, size, std::numeric_limits<double>::infinity()}, Vec3::Zero()};
  }
  Pair best;
  for (int i = 0; i < 3; ++i) best.keep_nearer(scene.corner_to_way(i));
  for (int i = 0; i < 3; ++i) best.keep_nearer(scene.edge_to_way(i));
  best.keep_nearer(scene.face_to_way());

  const Vec3 offset = best.along * scene.way -
                      (best.weights[0] * scene.corners[0] + best.weights[1] * scene.corners[1] +
                       best.weights[2] * scene.corners[2]);
  const double error = rounding * size;
  const double low = std::max(0.0, separation(scene, best.normal) - error);
  const double estimate = std::max(low, offset.norm());
  return {{low, estimate, estimate + error}, best.normal};
}

Bracket bracket_distance(const Segment& segment, const Triangle& triangle) noexcept {
  return gap_between(segment, triangle).distance;
}

}  // namespace keepout::monitor
