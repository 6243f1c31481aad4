// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/robot/motion_bounds.h"

#include <Eigen/Geometry>
#include <cmath>

namespace keepout {

MotionBounds motion_bounds(const ChainState& state, std::span<const double> increment, int link,
                           const Vec3& at) noexcept {
  MotionBounds bounds;
  for (int k = link; k >= 1; --k) {
    const double turn = std::abs(increment[static_cast<std::size_t>(k - 1)]);
    if (!state.turns(k)) {
      bounds.path += turn;
      continue;
    }
    // What joints beyond k can move the point to against link k, over the whole motion.
    const double lever = state.axis(k).cross(at - state.origin(k)).norm() + bounds.path;
    const double way = lever * turn;
    bounds.bend += turn * (way + 2.0 * bounds.path);
    bounds.path += way;
  }
  return bounds;
}

}  // namespace keepout
