// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// A bound of the rounding errors of a length, relative to the lengths from which it follows. Some
/// dozen operations have errors of 2^-53 each, so it is a thousand times larger than needed.
inline constexpr double outwards = 0x1p-40;

/// Returns a small capsule that contains all points, with its radius rounded up. A capsule is
/// convex, so it also contains the convex hull of the points, and each solid whose corners they
/// are. It is the smallest of the capsules along the principal axes and the coordinate axes.
/// Precondition: one point or more. [length]
Capsule enclosing_capsule(std::span<const Vec3> points);

}  // namespace keepout
