// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/haptic_force.h"

#include <limits>

#include "require_number.h"

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
  require_number("haptic spring: stiffness", spring.stiffness, above_zero(most));
  require_number("haptic spring: damping", spring.damping, {0.0, most});
  require_number("haptic spring: largest_force", spring.largest_force, above_zero(most));
  require_number("haptic spring: largest_rise", spring.largest_rise,
                 above_zero(std::numeric_limits<double>::infinity()));
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
