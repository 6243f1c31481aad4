// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/ball.h"
#include "keepout/geometry/box.h"

namespace keepout {

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

}  // namespace keepout
