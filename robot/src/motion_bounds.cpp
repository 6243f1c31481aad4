// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/robot/motion_bounds.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "keepout/robot/instrument_options.h"

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

double recommended_band(const Instrument& instrument, double period, double least) {
  const Chain& chain = instrument.chain();
  double most = 0.0;
  for (const LinkPoint& point : instrument.points()) {
    double lever = point.position.norm();  // from joint k to the point, at the most
    double path = 0.0;
    double bend = 0.0;
    for (int k = point.link; k >= 1; --k) {
      const Joint& joint = chain.joint(k);
      const double step = std::min(joint.limits.velocity * period, joint.limits.increment);
      if (joint.kind == JointKind::prismatic) {
        path += step;
        lever += std::max(std::abs(joint.limits.lower), std::abs(joint.limits.upper));
      } else {
        bend += step * ((lever + path) * step + 2.0 * path);
        path += (lever + path) * step;
      }
      lever += joint.origin.position.norm();
    }
    // Without a limit the bend is infinite, or 0 times infinity.
    most = std::isnan(bend) ? std::numeric_limits<double>::infinity() : std::max(most, bend);
    if (std::isinf(most)) break;
  }
  return std::max(least, most / 8.0);
}

}  // namespace keepout
