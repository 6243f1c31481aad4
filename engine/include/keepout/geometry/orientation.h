// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/shapes.h"

namespace keepout {

// Questions about where points lie, answered with the sign of the real number and not of its
// rounding: -1, 0 or 1. A quick test in doubles decides nearly always; when its error bound does
// not allow that, the sum is taken exactly (Shewchuk, "Adaptive precision floating-point arithmetic
// and fast robust geometric predicates", 1997). Exact as long as no product of three coordinate
// differences underflows or overflows: sizes from 1e-90 to 1e90 are safe.

/// The side of the plane through a, b, c on which d lies: 1 on the side that sees a, b, c wound
/// counter-clockwise, which is the side of the normal; 0 in the plane, or when there is no plane.
int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) noexcept;

/// The turn a, b, c makes in the plane of two of the axes: 1 counter-clockwise, 0 straight.
/// `axis` (0, 1, 2) is the one looked along.
int turn(const Vec3& a, const Vec3& b, const Vec3& c, int axis) noexcept;

/// An axis along which the triangle, seen so, has an area; or -1 when its corners are on one line.
int axis_of_sight(const Triangle& triangle) noexcept;

}  // namespace keepout
