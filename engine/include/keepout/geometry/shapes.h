// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

#include "keepout/ids.h"

#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || \
    defined(_M_FP_FAST) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ > 0)
#error "compile without -ffast-math or a part of it: proofs count on each rounding, and on NaN"
#endif

namespace keepout {

/// The range of lengths, whatever their unit: shorter ones, except 0, and longer ones are refused,
/// as their squares would leave the range of a float.
inline constexpr double shortest_length = 1e-15;
/// See shortest_length.
inline constexpr double longest_length = 1e15;

/// A point or a displacement, in the world unless another frame is named. [length]
using Vec3 = Eigen::Vector3d;

/// All points within `radius` of `center`, the boundary included. The motion sphere of Li et al.
/// (2020) is one: it contains every position that the tip can reach in one control cycle.
struct Ball {
  Vec3 center;    // [length]
  double radius;  // [length], >= 0
};

/// All points within `radius` of a segment.
struct Capsule {
  Vec3 from;      // the segment's ends [length]
  Vec3 to;        // the other one [length]
  double radius;  // [length], >= 0
};

/// An axis-aligned box. [length]
struct Box {
  Vec3 low;   // the corner with the least coordinates
  Vec3 high;  // the corner with the largest

  /// Halfway between the corners. [length]
  Vec3 center() const noexcept { return 0.5 * (low + high); }
  /// The lengths of its sides, >= 0 unless it is empty. [length]
  Vec3 size() const noexcept { return high - low; }
};

/// From a point to a box, 0 within it. [length]
inline double distance_to(const Box& box, const Vec3& point) noexcept {
  return (point - point.cwiseMax(box.low).cwiseMin(box.high)).norm();
}

/// The radius within which boxes around parts of a mesh with these bounds, tested in double, are
/// not to be passed over: the ball's, and what the exact kernel and the test may round differently.
/// Each loses some 1e-15 of the lengths involved, which are at most the ball's radius and its way
/// to the far end of the mesh. [length]
inline double padded_radius(const Ball& ball, const Box& bounds) noexcept {
  constexpr double rounding = 1e-13;
  const Vec3 from_middle = ball.center - bounds.center();
  return ball.radius +
         rounding * (ball.radius + from_middle.cwiseAbs().sum() + bounds.size().sum());
}

/// The square of the distance from a point to a box, 0 inside.
inline double squared_distance(const Box& box, const Vec3& point) noexcept {
  return (box.low - point).cwiseMax(point - box.high).cwiseMax(0.0).squaredNorm();
}

/// The three corners of a triangle, in the order of its winding. [length]
/// Edge e runs from corner e to corner (e + 1) % 3.
using Triangle = std::array<Vec3, 3>;

/// Unit normal by the right-hand rule; zero for a triangle without an area.
Vec3 unit_normal(const Triangle& triangle) noexcept;

/// The corners of a triangle in lexicographic order, relative to the tip. Ordered before the tip is
/// taken off, whose rounding could make different coordinates equal.
Triangle ordered_relative(const Triangle& triangle, const Vec3& tip) noexcept;

/// A plane, as it is called everywhere: the motions that it allows are all d with
/// normal . d >= offset. It is placed relative to the tip, so `offset` <= 0 means that standing
/// still is allowed.
struct HalfSpace {
  Vec3 normal;        // unit, towards the free side
  double offset;      // [length]
  TriangleId source;  // the triangle that it keeps the tip clear of; no_triangle if there is none
};

}  // namespace keepout
