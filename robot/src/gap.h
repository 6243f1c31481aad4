// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// What parts the core of a body, the hull of its points, from a triangle.
struct Gap {
  double distance = 0.0;  // that the plane proves; all but the true one. 0: they touch [length]
  Vec3 normal =
      Vec3::Zero();      // of that plane, from the triangle to the core: unit, zero if they touch
  double support = 0.0;  // max n . v over the triangle [length]
  Vec3 contact = Vec3::Zero();  // the core's nearest point [length]
};

/// How much work that is, of a core of so many points: see Budget.
constexpr std::size_t work_of_gap(std::size_t points) noexcept { return points > 2 ? 12 : 3; }

/// By the exact kernel and the nearest points of two segments, for a core of one or two points; by
/// the search of Gilbert, Johnson and Keerthi for others. Precondition: there is a point.
Gap gap(std::span<const Vec3> core, const Triangle& triangle) noexcept;

}  // namespace keepout
