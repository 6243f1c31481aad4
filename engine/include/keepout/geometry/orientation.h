// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/shapes.h"

namespace keepout {

// Exact predicates: each returns the sign of the real number (-1, 0 or 1), not of its rounding. A
// fast test in double precision nearly always decides. If its error bound is too large, the sum is
// computed exactly (Shewchuk, "Adaptive precision floating-point arithmetic and fast robust
// geometric predicates", 1997). The results are exact if no product of three coordinate differences
// underflows or overflows. This is the case for sizes from 1e-90 to 1e90.

/// Returns the side of the plane through a, b, c on which d lies. 1: the side of the normal, from
/// which a, b, c are counter-clockwise. 0: in the plane, or a, b, c define no plane.
int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) noexcept;

/// Returns the orientation of a, b, c in their projection along `axis` (0, 1, 2): 1
/// counter-clockwise, -1 clockwise, 0 collinear.
int turn(const Vec3& a, const Vec3& b, const Vec3& c, int axis) noexcept;

/// Returns an axis along which the projection of the triangle has an area; -1 if its corners are
/// collinear.
int axis_of_sight(const Triangle& triangle) noexcept;

}  // namespace keepout
