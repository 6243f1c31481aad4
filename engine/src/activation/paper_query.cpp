// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>

#include "paper_screen.h"

namespace keepout {

Ball idle_ball(const Vec3& aim) noexcept { return {0.5 * aim, 0.51 * aim.norm()}; }

PaperQuery paper_query(const Surroundings& around, double error, NeededPlanes needed) noexcept {
  // More than the rounding of a product and of the conversion itself.
  constexpr double up = 1.0 + 0x1p-20;
  constexpr double down = 1.0 - 0x1p-20;
  const Vec3& tip = around.ball.center;
  const double radius = around.ball.radius;
  const Ball idle = idle_ball(around.aim);
  PaperQuery query{};
  for (int axis = 0; axis < 3; ++axis) {
    query.high[axis] = static_cast<float>(tip[axis]);
    query.low[axis] = static_cast<float>(tip[axis] - static_cast<double>(query.high[axis]));
    query.middle[axis] = static_cast<float>(idle.center[axis]);
  }
  query.radius = static_cast<float>(radius * up);
  query.inside = static_cast<float>(radius * down);
  query.inside2 = static_cast<float>(radius * radius * down);
  query.outside2 = static_cast<float>(radius * radius * up);
  query.touch2 = static_cast<float>(around.rounding * around.rounding * up);
  query.rounding = static_cast<float>(around.rounding * up);
  // What two floats leave of the tip, and the rounding of a difference as small as `low`.
  const double split = 0x1p-46 * tip.cwiseAbs().maxCoeff();
  query.error = static_cast<float>(std::sqrt(3.0) * (error + split) * up);

  query.middle_length = static_cast<float>(idle.radius);
  query.idle_height = query.idle = query.idle2 = std::numeric_limits<float>::infinity();
  if (needed == NeededPlanes::in_the_way) {
    const double height = (idle.radius + around.margin) * up;
    const double distance = (idle.radius + idle.center.norm() + around.margin) * up;
    query.idle_height = static_cast<float>(height);
    query.idle = static_cast<float>(distance);
    query.idle2 = static_cast<float>(distance * distance * up);
  }
  return query;
}

}  // namespace keepout
