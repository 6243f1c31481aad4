// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// The nearest points of a triangle and a core, which is the convex hull of points.
struct NearestPoints {
  Vec3 on_triangle;  // the nearest point of the triangle [length]
  Vec3 to_core;      // from on_triangle to the nearest point of the core [length]
  double distance;   // |to_core| [length]
  bool overlap;      // triangle and core overlap or touch; the other members are then meaningless
  Vec3 normal;       // unit vector: the direction found that proves the largest distance
  double proven;  // the distance that a plane with that normal proves; nearly `distance` [length]
};

/// Returns the nearest points of a triangle and the core of `points`. Each iteration finds strictly
/// nearer points, so the search ends. If rounding ends it early, `proven` is less than `distance`.
/// Precondition: `points` is not empty.
///
/// Source: Gilbert, Johnson, Keerthi, "A fast procedure for computing the distance between complex
/// objects in three-dimensional space", 1988.
NearestPoints nearest_points(std::span<const Vec3> points, const Triangle& triangle) noexcept;

}  // namespace keepout
