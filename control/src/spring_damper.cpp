// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/spring_damper.h"

#include <algorithm>

#include "keepout/error.h"

namespace keepout {

double SpringDamper::spring_force(double stretch) const noexcept {
  return std::min(stiffness * stretch, largest_force);
}

double SpringDamper::force(double stretch, double rate) const noexcept {
  return std::clamp(stiffness * stretch + damping * rate, 0.0, largest_force);
}

double SpringDamper::stored(double stretch) const noexcept {
  const double linear = std::min(stretch, largest_force / stiffness);
  return 0.5 * stiffness * linear * linear + largest_force * (stretch - linear);
}

void check(const SpringDamper& spring) {
  constexpr double most = 1e9;  // beyond any device, and far from overflow
  if (!(spring.stiffness > 0.0 && spring.stiffness <= most)) {
    throw Error("haptic spring: its stiffness must be above 0 and at most 1e9");
  }
  if (!(spring.damping >= 0.0 && spring.damping <= most)) {
    throw Error("haptic spring: its damping must be 0 or above, and at most 1e9");
  }
  if (!(spring.largest_force > 0.0 && spring.largest_force <= most)) {
    throw Error("haptic spring: its largest force must be above 0 and at most 1e9");
  }
  if (!(spring.largest_rise > 0.0)) {
    throw Error("haptic spring: the largest rise of its force must be above 0");
  }
}

}  // namespace keepout
