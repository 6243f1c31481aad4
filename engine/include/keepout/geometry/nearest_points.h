// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// The nearest points of a triangle and the hull of some points, the core.
struct NearestPoints {
  Vec3 on_triangle;  // the triangle's nearest point [length]
  Vec3 to_core;      // from on_triangle to the nearest point of the core [length]
  double distance;   // |to_core| [length]
  bool overlap;      // the two overlap or touch: the other members mean nothing
  Vec3 normal;       // unit: the direction found that proves the largest distance
  double proven;     // by a plane with that normal; all but equal to the distance [length]
};

/// Finds them by Gilbert, Johnson, Keerthi, "A fast procedure for computing the distance between
/// complex objects in three-dimensional space", 1988. Each round comes strictly nearer, so the
/// search ends. Rounding can end it early; `proven` is then less than `distance`. Precondition:
/// there is a point.
NearestPoints nearest_points(std::span<const Vec3> points, const Triangle& triangle) noexcept;

}  // namespace keepout
