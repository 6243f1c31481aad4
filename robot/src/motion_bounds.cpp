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
    const double step = std::abs(increment[static_cast<std::size_t>(k - 1)]);
    if (state.turns(k)) {
      bounds.turn(state.axis(k).cross(at - state.origin(k)).norm(), step);
    } else {
      bounds.slide(step);
    }
  }
  return bounds;
}

double recommended_band(const Instrument& instrument, double period, double least) {
  option_named(instrument_options, "period").accepted(period);
  OptionText{"least", {}, OptionKind::number, {}, not_negative}.accepted(least);
  const Chain& chain = instrument.chain();
  double most = 0.0;
  for (const LinkPoint& point : instrument.points()) {
    double lever = point.position.norm();  // from joint k to the point, at the most
    MotionBounds bounds;
    for (int k = point.link; k >= 1; --k) {
      const Joint& joint = chain.joint(k);
      const double step = std::min(joint.limits.velocity * period, joint.limits.increment);
      if (joint.kind == JointKind::prismatic) {
        bounds.slide(step);
        lever += std::max(std::abs(joint.limits.lower), std::abs(joint.limits.upper));
      } else {
        bounds.turn(lever, step);
      }
      lever += joint.origin.position.norm();
    }
    // Without limits the second-derivative bound is infinite, or 0 times infinity.
    most = std::isnan(bounds.bend) ? std::numeric_limits<double>::infinity()
                                   : std::max(most, bounds.bend);
    if (std::isinf(most)) break;
  }
  return std::max(least, most / 8.0);
}

}  // namespace keepout
