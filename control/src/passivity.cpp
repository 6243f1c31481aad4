// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/passivity.h"

#include <algorithm>

namespace keepout {

void PassivityObserver::leave_contact() noexcept { energy_ = std::min(energy_, 0.0); }

Vec3 PassivityObserver::brake(const Vec3& hand_way, double period) const noexcept {
  const double way_squared = hand_way.squaredNorm();
  if (!(energy_ < 0.0) || !(way_squared > 0.0)) return Vec3::Zero();
  // alpha v^2 T = -energy, with v = way / T.
  const double alpha = std::min(-energy_ * period / way_squared, largest_brake_);
  return (-alpha / period) * hand_way;
}

}  // namespace keepout
