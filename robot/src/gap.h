// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// The gap between a triangle and the core of a body (the hull of its points), proved by a plane
/// between them.
struct Gap {
  double distance = 0.0;        // exact up to rounding; 0 if they touch [length]
  Vec3 normal = Vec3::Zero();   // from the triangle to the core: unit; zero if they touch
  Vec3 contact = Vec3::Zero();  // the nearest point of the core; zero if they touch [length]
};

/// Returns the least height of a core over a triangle along a normal. [length]
double height_along(const Vec3& normal, std::span<const Vec3> core,
                    const Triangle& triangle) noexcept;

/// Returns the gap. Uses the exact kernel and the nearest points of two segments for a core of one
/// or two points, and the search of Gilbert, Johnson and Keerthi (1988) for others. Precondition:
/// the core has a point.
Gap gap(std::span<const Vec3> core, const Triangle& triangle) noexcept;

}  // namespace keepout
