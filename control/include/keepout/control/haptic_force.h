// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// A spring and a damper between the hand and its proxy, along the line between them. The force
/// points from the hand to the proxy or is zero: it never sucks the hand towards the surface.
///
/// A display that is updated every T seconds is passive if its own damping b is at least
/// stiffness T / 2 + damping (Colgate and Schenkel 1994): a stiff spring needs a fast loop.
struct SpringDamper {
  double stiffness = 1.0;      // [N / length], > 0
  double damping = 0.0;        // [N s / length], >= 0
  double largest_force = 4.0;  // the force saturates there [N], > 0
  double largest_rise = std::numeric_limits<double>::infinity();  // of the force [N / s], > 0

  /// The spring's part at a stretch: stiffness times it, up to the largest force. [N]
  double spring_force(double stretch) const noexcept;

  /// Spring and damper: not below 0, nor above the largest force. `rate`: of the stretch.
  /// [length / s]
  double force(double stretch, double rate) const noexcept;

  /// What the spring holds at a stretch: the integral of spring_force. [N length]
  double stored(double stretch) const noexcept;
};

/// Throws Error when a number is out of range, naming it.
void check(const SpringDamper& spring);

/// The time-domain passivity observer and controller of Hannaford and Ryu, "Time-domain passivity
/// control of haptic interfaces", IEEE Trans. Robotics and Automation 18(1), 2002, in its series
/// form: the hand's velocity goes in, a force comes out.
///
/// The observer counts what the hand puts into a contact less what it gets out. Below 0, the
/// display has been active; the controller then brakes the hand until the debt is paid. Only in
/// contact, so that free space stays free: what is owed at the end of one contact is paid in the
/// next; what is left over is dropped, as it would hide the activity of the next.
class PassivityObserver {
 public:
  /// `largest_brake`: damping that the controller may use at most [N s / length], >= 0; 0: it only
  /// observes.
  explicit PassivityObserver(double largest_brake = 0.0) noexcept : largest_brake_(largest_brake) {}

  /// Owes nothing, and is owed nothing.
  void restart() noexcept { energy_ = 0.0; }

  /// Books a cycle past: the force held, and the way of the hand meanwhile.
  void observe(const Vec3& force, const Vec3& hand_way) noexcept { energy_ -= force.dot(hand_way); }

  /// No contact: what is left over is dropped.
  void leave_contact() noexcept { energy_ = std::min(energy_, 0.0); }

  /// The force that dissipates the debt in one cycle of `period` [s], provided that the hand goes
  /// on as it went in the last one. Zero while there is none.
  Vec3 brake(const Vec3& hand_way, double period) const noexcept;

  /// What the hand has put into this contact less what it got; below 0: owed. [N length]
  double energy() const noexcept { return energy_; }

 private:
  double largest_brake_;
  double energy_ = 0.0;
};

/// What acts in a cycle, until the next one.
struct HeldForce {
  Vec3 spring = Vec3::Zero();  // between the proxy and the hand, on the hand [N]
  Vec3 brake = Vec3::Zero();   // between the ground and the hand, on the hand [N]

  /// What the hand feels. [N]
  Vec3 total() const noexcept { return spring + brake; }
};

/// Where the energy of a haptic display went since it was engaged. [N length]: millijoules, when
/// the mesh is in millimeters. It adds up, to rounding:
///
///     to_hand + stored + dissipated = from_proxy
struct EnergyReport {
  double to_hand = 0.0;  // work on the hand; below 0: the hand has put in that much
  double stored = 0.0;   // in the spring
  /// In the damper, in saturation and in the brake, less what sampling made out of nothing: a
  /// spring whose force is late by a cycle gives back more than it took.
  double dissipated = 0.0;
  double from_proxy = 0.0;  // work of the proxy on the spring: of the surface, when it gives way
  /// The most that the hand has ever been owed, as PassivityObserver counts: what contacts gave it
  /// beyond what it had put into them. 0 when the display was passive throughout.
  double active = 0.0;
  double braked = 0.0;           // by the passivity controller
  double largest_force = 0.0;    // [N]
  std::size_t cycles = 0;        // all of them
  std::size_t blind_cycles = 0;  // without a hand to observe: their work is not in the sums

  /// Books what was held over the cycle past, in which hand and proxy went so far. A force is held
  /// for a cycle, so its work on the way of the hand is exact. `now_stored`: what the spring holds
  /// now.
  void book(const HeldForce& held, const Vec3& hand_way, const Vec3& proxy_way,
            double now_stored) noexcept;

  /// A cycle in which the hand was not seen. What the spring holds less or more since is taken to
  /// be lost to, or made by, damping.
  void book_blind(double now_stored) noexcept;
};

}  // namespace keepout
