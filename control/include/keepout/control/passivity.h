// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/vec3.h"

namespace keepout {

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
  /// `largest_brake`: damping that the controller may use at most [N s / length]; 0: it only
  /// observes.
  explicit PassivityObserver(double largest_brake = 0.0) noexcept : largest_brake_(largest_brake) {}

  /// Owes nothing, and is owed nothing.
  void restart() noexcept { energy_ = 0.0; }

  /// Books a cycle past: the force held, and the way of the hand meanwhile.
  void observe(const Vec3& force, const Vec3& hand_way) noexcept { energy_ -= force.dot(hand_way); }

  /// No contact: what is left over is dropped.
  void leave_contact() noexcept;

  /// The force that dissipates the debt in one cycle of `period` [s], provided that the hand goes
  /// on as it went in the last one. Zero while there is none.
  Vec3 brake(const Vec3& hand_way, double period) const noexcept;

  /// What the hand has put into this contact less what it got; below 0: owed. [N length]
  double energy() const noexcept { return energy_; }

 private:
  double largest_brake_;
  double energy_ = 0.0;
};

}  // namespace keepout
