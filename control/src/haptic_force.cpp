// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/haptic_force.h"

#include <string>

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
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw Error(std::string("haptic spring: ") + what);
  };
  require(spring.stiffness > 0.0 && spring.stiffness <= most,
          "its stiffness must be above 0 and at most 1e9");
  require(spring.damping >= 0.0 && spring.damping <= most,
          "its damping must be 0 or above, and at most 1e9");
  require(spring.largest_force > 0.0 && spring.largest_force <= most,
          "its largest force must be above 0 and at most 1e9");
  require(spring.largest_rise > 0.0, "the largest rise of its force must be above 0");
}

Vec3 PassivityObserver::brake(const Vec3& hand_way, double period) const noexcept {
  const double way_squared = hand_way.squaredNorm();
  if (!(energy_ < 0.0) || !(way_squared > 0.0)) return Vec3::Zero();
  // alpha v^2 T = -energy, with v = way / T.
  const double alpha = std::min(-energy_ * period / way_squared, largest_brake_);
  return (-alpha / period) * hand_way;
}

void EnergyReport::book(const HeldForce& held, const Vec3& hand_way, const Vec3& proxy_way,
                        double now_stored) noexcept {
  const double brake_work = -held.brake.dot(hand_way);
  to_hand += held.total().dot(hand_way);
  from_proxy += held.spring.dot(proxy_way);
  dissipated += held.spring.dot(proxy_way - hand_way) - (now_stored - stored) + brake_work;
  braked += brake_work;
  stored = now_stored;
  ++cycles;
}

void EnergyReport::book_blind(double now_stored) noexcept {
  dissipated -= now_stored - stored;
  stored = now_stored;
  ++cycles;
  ++blind_cycles;
}

}  // namespace keepout
