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

/// The least length above 0 that is accepted, in any unit; see longest_length. Squares of lengths
/// outside this range would leave the range of a float.
inline constexpr double shortest_length = 1e-15;
/// The largest length that is accepted; see shortest_length.
inline constexpr double longest_length = 1e15;

/// A point or a displacement, in the world frame unless another frame is named. [length]
using Vec3 = Eigen::Vector3d;

/// All points within `radius` of `center`, including the boundary. The motion sphere of Li et al.
/// (2020) is a ball that contains every position that the tip can reach in one control cycle.
struct Ball {
  Vec3 center;    // [length]
  double radius;  // [length], >= 0
};

/// All points within `radius` of a segment.
struct Capsule {
  Vec3 from;      // the first end of the segment [length]
  Vec3 to;        // the second end [length]
  double radius;  // [length], >= 0
};

/// An axis-aligned box. [length]
struct Box {
  Vec3 low;   // the corner with the least coordinates
  Vec3 high;  // the corner with the largest coordinates

  /// Returns the center. [length]
  Vec3 center() const noexcept { return 0.5 * (low + high); }
  /// Returns the lengths of the sides, >= 0 unless the box is empty. [length]
  Vec3 size() const noexcept { return high - low; }
};

/// Returns the distance from a point to a box, 0 inside. [length]
inline double distance_to(const Box& box, const Vec3& point) noexcept {
  return (point - point.cwiseMax(box.low).cwiseMin(box.high)).norm();
}

/// Returns an enlarged radius of a ball, for tests of boxes in double precision. With this radius,
/// the test misses no box that the ball touches. `bounds`: of the mesh. The enlarged radius is the
/// ball's radius plus the roundings of the exact kernel and of the test. Each rounding is about
/// 1e-15 of the lengths involved. These are at most the ball's radius plus its distance to the far
/// end of the mesh. [length]
inline double padded_radius(const Ball& ball, const Box& bounds) noexcept {
  constexpr double rounding = 1e-13;
  const Vec3 from_middle = ball.center - bounds.center();
  return ball.radius +
         rounding * (ball.radius + from_middle.cwiseAbs().sum() + bounds.size().sum());
}

/// Returns the squared distance from a point to a box, 0 inside. [length^2]
inline double squared_distance(const Box& box, const Vec3& point) noexcept {
  return (box.low - point).cwiseMax(point - box.high).cwiseMax(0.0).squaredNorm();
}

/// The three corners of a triangle, in the order of its winding. [length]
/// Edge e runs from corner e to corner (e + 1) % 3.
using Triangle = std::array<Vec3, 3>;

/// Returns the unit normal by the right-hand rule; zero for a triangle without an area.
Vec3 unit_normal(const Triangle& triangle) noexcept;

/// Returns the corners of a triangle in lexicographic order, relative to the tip. The order is that
/// of the mesh's coordinates: the rounding of the subtraction could make different coordinates
/// equal.
Triangle ordered_relative(const Triangle& triangle, const Vec3& tip) noexcept;

/// A half-space of motions, called a plane. It allows all motions d with normal . d >= offset. It
/// is relative to the tip, so zero motion is allowed if `offset` <= 0.
struct HalfSpace {
  Vec3 normal;        // unit, towards the free side
  double offset;      // [length]
  TriangleId source;  // the triangle that the tip must clear, or no_triangle
};

}  // namespace keepout
