// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// Where the hull of some points, the core, and a triangle come nearest to one another.
struct NearestPoints {
  Vec3 on_triangle;  // the triangle's nearest point [length]
  Vec3 to_core;      // from there to the nearest point of the core [length]
  double distance;   // |to_core| [length]
  bool overlap;      // the two overlap or touch: nothing else is meant
  Vec3 normal;       // unit: the best direction found to prove the distance with
  double proven;     // by a plane with that normal; all but equal to the distance [length]
};

/// Gilbert, Johnson, Keerthi, "A fast procedure for computing the distance between complex objects
/// in three-dimensional space", 1988. Each round comes strictly nearer, so it ends; and rounding
/// alone can end it early, which `proven` then shows.
/// Precondition: there is a point.
NearestPoints nearest_points(std::span<const Vec3> points, const Triangle& triangle) noexcept;

}  // namespace keepout
