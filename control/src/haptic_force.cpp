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

void check(const HapticOptions& options) {
  constexpr double most = 1e30;  // far from overflow
  check(options.spring);
  require_number("haptic proxy: period, in seconds", options.period, {1e-6, 1.0});
  require_number("haptic proxy: top_speed", options.top_speed, above_zero(most));
  require_number("haptic proxy: farthest", options.farthest, above_zero(most));
  require_number("haptic proxy: fade, from one period on", options.fade, {options.period, 10.0});
  require_number("haptic proxy: largest_brake", options.largest_brake, {0.0, most});
}

HapticForce::HapticForce(const HapticOptions& options) noexcept
    : spring_(options.spring),
      period_(options.period),
      fade_(options.fade),
      passivity_(options.largest_brake) {}

void HapticForce::engage(const Vec3& position) noexcept {
  release();
  energy_ = {};
  proxy_ = hand_ = position;
  seen_ = true;
}

void HapticForce::release() noexcept {
  passivity_.restart();
  held_ = {};
  hand_way_ = Vec3::Zero();
  stretch_ = 0.0;
  share_ = 1.0;
  seen_ = false;
}

void HapticForce::follow(const Vec3& hand, const Vec3& proxy) noexcept {
  change_share(1.0);
  book(hand, proxy);
  update();
}

void HapticForce::fade(const Vec3& hand) noexcept {
  change_share(0.0);
  book(hand, proxy_);
  update();
}

void HapticForce::fade() noexcept {
  const double before = share_;
  change_share(0.0);
  const double left = before > 0.0 ? share_ / before : 0.0;
  // Without the brake at once, the total force could rise.
  held_.spring *= left;
  held_.brake *= left;
  energy_.book_blind(share_ * spring_.stored(stretch_));
  seen_ = false;
}

void HapticForce::change_share(double towards) noexcept {
  const double change = period_ / fade_;
  share_ = towards > share_ ? std::min(share_ + change, 1.0) : std::max(share_ - change, towards);
}

void HapticForce::book(const Vec3& hand, const Vec3& proxy) noexcept {
  const double stretch = (proxy - hand).norm();
  const double stored = share_ * spring_.stored(stretch);
  rate_ = 0.0;
  hand_way_ = Vec3::Zero();
  if (seen_) {
    hand_way_ = hand - hand_;
    rate_ = (stretch - stretch_) / period_;
    passivity_.observe(held_.total(), hand_way_);
    energy_.book(held_, hand_way_, proxy - proxy_, stored);
    energy_.active = std::max(energy_.active, -passivity_.energy());
  } else {
    energy_.book_blind(stored);
  }
  proxy_ = proxy;
  hand_ = hand;
  stretch_ = stretch;
  seen_ = true;
}

void HapticForce::update() noexcept {
  const double newtons_before = held_.spring.norm();
  held_ = {};
  if (!(stretch_ > 0.0)) {
    passivity_.leave_contact();
    return;
  }
  const double newtons = std::min(share_ * spring_.force(stretch_, rate_),
                                  newtons_before + spring_.largest_rise * period_);
  held_.spring = (newtons / stretch_) * (proxy_ - hand_);
  held_.brake = share_ * passivity_.brake(hand_way_, period_);
  const double total = held_.total().norm();
  if (total > spring_.largest_force) {
    held_.spring *= spring_.largest_force / total;
    held_.brake *= spring_.largest_force / total;
  }
  energy_.largest_force = std::max(energy_.largest_force, held_.total().norm());
}

}  // namespace keepout
