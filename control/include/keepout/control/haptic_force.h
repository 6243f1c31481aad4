// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "keepout/geometry/shapes.h"
#include "keepout/step/guide.h"

namespace keepout {

/// A spring and a damper between the operator's hand and its proxy. The force points from the hand
/// to the proxy or is zero: it never pulls the hand towards the surface.
///
/// A haptic device that is updated every T seconds is passive if its own damping b is at least
/// stiffness T / 2 + damping (Colgate and Schenkel 1994). So a stiff spring needs a fast loop.
struct SpringDamper {
  double stiffness = 1.0;      // [N / length], > 0
  double damping = 0.0;        // [N s / length], >= 0
  double largest_force = 4.0;  // the force saturates at this value [N], > 0
  double largest_rise = std::numeric_limits<double>::infinity();  // of the force [N / s], > 0

  /// Returns the force of the spring at a stretch: stiffness times stretch, up to the largest
  /// force. [N]
  double spring_force(double stretch) const noexcept;

  /// Returns the force of spring and damper, from 0 to the largest force [N]. `rate`: of the
  /// stretch [length / s].
  double force(double stretch, double rate) const noexcept;

  /// Returns the energy of the spring at a stretch: the integral of spring_force. [N length]
  double stored(double stretch) const noexcept;
};

/// Throws Error, which names the number, if a number is out of range.
void check(const SpringDamper& spring);

/// The time-domain passivity observer and controller of Hannaford and Ryu, "Time-domain passivity
/// control of haptic interfaces", IEEE Trans. Robotics and Automation 18(1), 2002, in its series
/// form: the input is the hand's velocity, the output is a force.
///
/// The observer sums the energy that the hand puts into a contact minus the energy that it
/// receives. If the sum is below 0 (a deficit), the device has generated energy. The controller
/// then brakes the hand until the deficit is dissipated. It brakes only in contact, so that motion
/// in free space is not damped. At the end of a contact, a deficit carries over to the next
/// contact. A surplus is dropped, because it would hide energy that the device generates later.
class PassivityObserver {
 public:
  /// `largest_brake`: the largest damping of the controller [N s / length], >= 0; 0: only observes.
  explicit PassivityObserver(double largest_brake = 0.0) noexcept : largest_brake_(largest_brake) {}

  /// Resets the energy to 0.
  void restart() noexcept { energy_ = 0.0; }

  /// Adds the last cycle: the held force and the displacement of the hand.
  void observe(const Vec3& force, const Vec3& hand_way) noexcept { energy_ -= force.dot(hand_way); }

  /// Ends a contact: drops a surplus.
  void leave_contact() noexcept { energy_ = std::min(energy_, 0.0); }

  /// Returns the force that dissipates the deficit in one cycle of `period` [s] if the hand repeats
  /// its last displacement; zero without a deficit. [N]
  Vec3 brake(const Vec3& hand_way, double period) const noexcept;

  /// Returns the energy that the hand has put into this contact minus the energy that it received;
  /// below 0 for a deficit. [N length]
  double energy() const noexcept { return energy_; }

 private:
  double largest_brake_;
  double energy_ = 0.0;
};

/// The forces on the hand from a cycle until the next one.
struct HeldForce {
  Vec3 spring = Vec3::Zero();  // of the spring between proxy and hand [N]
  Vec3 brake = Vec3::Zero();   // of the passivity controller, against the ground [N]

  /// Returns the sum of the forces. [N]
  Vec3 total() const noexcept { return spring + brake; }
};

/// The energies of a haptic device since it was engaged. [N length], which is mJ if the mesh is in
/// mm. Except for rounding:
///
///     to_hand + stored + dissipated = from_proxy
struct EnergyReport {
  double to_hand = 0.0;  // work on the hand; below 0 if the hand has put energy in
  double stored = 0.0;   // in the spring now
  /// Dissipated by damper, saturation and brake, minus the energy that sampling generates. (The
  /// force of a sampled spring is late by a cycle, so the spring returns more energy than it
  /// received.)
  double dissipated = 0.0;
  double from_proxy = 0.0;  // work of the proxy on the spring
  /// The largest deficit that the PassivityObserver found: the energy that contacts gave to the
  /// hand, minus the energy that the hand had put in. 0 if the device was always passive.
  double active = 0.0;
  double braked = 0.0;           // dissipated by the passivity controller
  double largest_force = 0.0;    // [N]
  std::size_t cycles = 0;        // all cycles
  std::size_t blind_cycles = 0;  // without a measured hand; their work is not included

  /// Adds the last cycle: the held forces and the displacements of hand and proxy. The work on the
  /// hand is exact, as a force is constant in a cycle. `now_stored`: the energy of the spring now.
  void book(const HeldForce& held, const Vec3& hand_way, const Vec3& proxy_way,
            double now_stored) noexcept;

  /// Adds a cycle without a measured hand. The change of the spring's energy counts as dissipated.
  void book_blind(double now_stored) noexcept;
};

/// The options of a proxy and its force.
struct HapticOptions {
  double period = 0.001;     // of a cycle [s], 1e-6 to 1
  SpringDamper spring = {};  // between proxy and hand
  double top_speed = 200.0;  // of the proxy, which the robot follows [length / s], > 0
  double farthest = 50.0;    // from proxy to hand; farther goals are rejected [length], > 0
  /// The time in which the force fades out when cycles fail, and returns afterwards [s], >= period
  double fade = 0.05;
  double largest_brake = 0.0;  // of the passivity controller [N s / length]; 0: only observes
  /// Guides of a tip, in the frame of the mesh: Guide::point. They replace the guides of the motion
  /// constraint. An empty list leaves them.
  std::vector<Guide> guides = {};
};

/// Throws Error, which names the option, if an option is out of range.
void check(const HapticOptions& options);

/// The force that pulls the operator's hand to its proxy, from cycle to cycle. Positions are in the
/// frame and the unit of the mesh. No function allocates, locks or throws.
///
/// If a cycle fails, the force fades out over `fade` seconds. The force must not vanish at once,
/// because the hand leans against it. It must not stay either, because a motor must not push after
/// a fault. While the hand is measured, the spring still connects it to the proxy, and the force of
/// the spring fades. While the hand is not measured, the last force fades. From the next successful
/// cycle on, the force returns over the same time.
class HapticForce {
 public:
  /// Precondition: the options are checked.
  explicit HapticForce(const HapticOptions& options) noexcept;

  /// Sets hand and proxy to one position. The force is zero, and all energies are reset.
  void engage(const Vec3& position) noexcept;
  /// Sets the force to zero at once. Does not reset the energies.
  void release() noexcept;

  /// Adds a successful cycle, in which the proxy has moved to `proxy`.
  void follow(const Vec3& hand, const Vec3& proxy) noexcept;
  /// Adds a failed cycle with a measured hand: the proxy did not move.
  void fade(const Vec3& hand) noexcept;
  /// Adds a failed cycle without a measured hand: the last force fades.
  void fade() noexcept;

  /// Returns the force on the hand until the next cycle. [N]
  Vec3 force() const noexcept { return held_.total(); }
  /// Returns the energies since engage().
  const EnergyReport& energy() const noexcept { return energy_; }

 private:
  /// Adds the last cycle to the energies, and stores the positions of hand and proxy.
  void book(const Vec3& hand, const Vec3& proxy) noexcept;
  void update() noexcept;
  void change_share(double towards) noexcept;

  SpringDamper spring_;
  double period_;  // [s]
  double fade_;    // [s]
  PassivityObserver passivity_;
  EnergyReport energy_;
  HeldForce held_;  // the forces since the last cycle
  Vec3 proxy_ = Vec3::Zero();
  Vec3 hand_ = Vec3::Zero();      // the last measured position
  Vec3 hand_way_ = Vec3::Zero();  // displacement in the last cycle; zero if not known
  double stretch_ = 0.0;          // between proxy and hand in the last cycle [length]
  double rate_ = 0.0;             // of the stretch [length / s]
  double share_ = 1.0;            // the fraction of the force that has not faded
  bool seen_ = false;             // true if the hand was measured in the last cycle
};

}  // namespace keepout
