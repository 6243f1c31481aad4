// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "keepout/geometry/vec3.h"

namespace keepout {

/// Where the energy of a haptic display went since it was engaged. [N length]: millijoules, when
/// the mesh is in millimetres. It adds up, to rounding:
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
};

/// What acts in a cycle, until the next one.
struct HeldForce {
  Vec3 spring = Vec3::Zero();  // between the proxy and the hand, on the hand [N]
  Vec3 brake = Vec3::Zero();   // between the ground and the hand, on the hand [N]

  /// What the hand feels. [N]
  Vec3 total() const noexcept { return spring + brake; }
};

/// Adds the energies up. A force is held for a cycle, so its work on the way of the hand is exact.
class EnergyAccount {
 public:
  /// Starts anew, with nothing stored.
  void restart() noexcept { *this = {}; }

  /// Books what was held over the cycle past, in which hand and proxy went so far. `stored`: what
  /// the spring holds now.
  void book(const HeldForce& held, const Vec3& hand_way, const Vec3& proxy_way,
            double stored) noexcept;

  /// A cycle in which the hand was not seen. What the spring holds less or more since is taken to
  /// be lost to, or made by, damping.
  void book_blind(double stored) noexcept;

  /// Takes down what the hand is owed; the report keeps the most. [N length]
  void note_active(double energy) noexcept;
  /// Takes down how large the force is; the report keeps the largest. [N]
  void note_force(double newtons) noexcept;

  /// The sums so far.
  const EnergyReport& report() const noexcept { return report_; }

 private:
  EnergyReport report_;
};

}  // namespace keepout
