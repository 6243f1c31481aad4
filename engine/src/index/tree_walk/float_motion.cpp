// SPDX-License-Identifier: BSD-3-Clause
#include "filters.h"

namespace keepout {

FloatTip float_tip(const Vec3& tip) noexcept {
  FloatTip split;
  for (int axis = 0; axis < 3; ++axis) {
    split.high[axis] = static_cast<float>(tip[axis]);
    split.low[axis] = static_cast<float>(tip[axis] - static_cast<double>(split.high[axis]));
  }
  return split;
}

FloatReach float_reach(double margin, double longest, const Vec3& tip, double error) noexcept {
  // What the two floats of the tip leave over, and what the leaf's coordinates are off by.
  const double fixed = 1e-13 * tip.lpNorm<1>() + 4.0 * error;
  const double slack = 2e-6 * margin + 3e-6 * longest + fixed;
  const double boxes = margin * (1.0 + 2e-6) + 4e-6 * longest + fixed;
  constexpr double up = 1.0 + 1e-6;
  return {static_cast<float>(margin * up), 1.5e-6f, static_cast<float>(slack * up),
          static_cast<float>(boxes * up)};
}

}  // namespace keepout
