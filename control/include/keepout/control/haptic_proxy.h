// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "keepout/control/haptic_force.h"
#include "keepout/step/guide.h"
#include "keepout/step/motion_constraint.h"

namespace keepout {

/// The outcome of a controller's cycle. With `guarded`, the proxy has moved by the step. With all
/// others, the proxy has not moved.
enum class CycleStatus : std::uint8_t {
  guarded,        // the step was ok: HapticCycle::step and limits have the details
  not_engaged,    // engage() has not set the proxy yet: there is no force
  invalid_pose,   // a number is not finite, or the matrix is not a rotation
  too_far,        // the goal is too far from the proxy: wrong unit, or a jump
  stale,          // no goal arrived for too long
  lagging,        // the robot is too far from its setpoint
  far_from_mesh,  // at engage(): too far from the mesh; check unit and registration
  stopped         // the step failed: see HapticCycle::step
};

/// Returns true if the proxy has moved by the step.
constexpr bool is_ok(CycleStatus status) noexcept { return status == CycleStatus::guarded; }

/// Returns the name of the enumerator, for logs.
std::string_view name(CycleStatus status) noexcept;

/// Returns one line on what happened and what to do about it.
std::string_view reason(CycleStatus status) noexcept;

/// The options of a HapticProxy.
struct HapticOptions {
  double period = 0.001;     // of a cycle [s], 1e-6 to 1
  SpringDamper spring = {};  // between proxy and hand
  double top_speed = 200.0;  // of the proxy, which the robot follows [length / s], > 0
  double farthest = 50.0;    // from proxy to hand; farther goals are rejected [length], > 0
  /// The time in which the force fades out when cycles fail, and returns afterwards [s], >= period
  double fade = 0.05;
  double largest_brake = 0.0;      // of the passivity controller [N s / length]; 0: only observes
  std::vector<Guide> guides = {};  // of the proxy, in the frame of the mesh: Guide::point
};

/// The result of a cycle.
struct HapticCycle {
  CycleStatus status = CycleStatus::not_engaged;  // the outcome of the cycle
  Status step = Status::invalid_input;  // of the motion constraint; only if guarded or stopped
  Limits limits = {};                   // the limits of the step
  Vec3 proxy = Vec3::Zero();            // the target position of the tool [length]
  Vec3 force = Vec3::Zero();            // on the hand until the next cycle [N]

  /// Returns true if the proxy has moved by the step.
  bool ok() const noexcept { return is_ok(status); }
  /// Returns one line on what happened and what to do about it; for a stopped cycle, the reason of
  /// the step.
  std::string_view reason() const noexcept {
    return status == CycleStatus::stopped ? keepout::reason(step, Subject::tip)
                                          : keepout::reason(status);
  }
};

/// A proxy of the operator's hand that stays out of the mesh, and the force that pulls the hand to
/// it. It is the god-object of Zilles and Salisbury (1995) with the certified step as its
/// constraint. All values are in the frame and the unit of the mesh. Not thread-safe. A cycle does
/// not allocate, lock or throw.
///
/// If a cycle fails, the proxy does not move, and the force fades out over `fade` seconds. The
/// force must not vanish at once, because the hand leans against it. It must not stay either,
/// because a motor must not push after a fault. While the hand is measured, the spring still
/// connects it to the proxy, and the force of the spring fades. While the hand is not measured, the
/// last force fades. From the next successful cycle on, the force returns over the same time.
class HapticProxy {
 public:
  /// Makes a proxy. The longest motion of a cycle is top_speed * period, or the radius of the
  /// motion sphere if that is smaller. The recovery of the guard is limited to the same length.
  /// Throws Error for an option out of range, and for guides that MotionConstraint::set_guides
  /// rejects.
  HapticProxy(MotionConstraint guard, const HapticOptions& options);

  /// Sets proxy and hand to a tip: at the start, and after the hand has moved without the proxy
  /// (after clutching). The force is zero, and all energies are reset. Returns guarded or
  /// invalid_pose.
  CycleStatus engage(const Vec3& tip) noexcept;

  /// Releases: the force is zero at once, and no cycle runs until engage(). Does not reset the
  /// energies.
  void release() noexcept;

  /// Runs one cycle: moves the proxy towards the hand as far as the mesh allows. [length]
  HapticCycle cycle(const Vec3& hand) noexcept;

  /// Runs a cycle in which the proxy does not move and the hand is not measured: the last force
  /// fades. `why`: the status of the cycle.
  HapticCycle stand(CycleStatus why) noexcept;
  /// Like stand(CycleStatus), with a measured hand: the force of the spring fades. [length]
  HapticCycle stand(CycleStatus why, const Vec3& hand) noexcept;

  /// Returns the target position of the tool. [length]
  const Vec3& proxy() const noexcept { return proxy_; }
  /// Returns true if the proxy was engaged and not released since.
  bool engaged() const noexcept { return engaged_; }
  /// Returns the state of each guide of the options in the last step; empty before the first step.
  std::span<const GuideState> guides() const noexcept { return guide_states_; }
  /// Returns the work of the last step: see Budget.
  std::size_t work_units() const noexcept { return guard_.work_units(); }
  /// Returns work_units().
  [[deprecated("use work_units()")]] std::size_t looks() const noexcept { return work_units(); }
  /// Returns the energies since the proxy was engaged.
  const EnergyReport& energy() const noexcept { return energy_; }
  /// Returns the options.
  const HapticOptions& options() const noexcept { return options_; }
  /// Returns the mesh.
  const Mesh& mesh() const noexcept { return guard_.mesh(); }

 private:
  /// Adds the last cycle to the energies, and stores the position of the hand.
  void book(const Vec3& hand, const Vec3& proxy_way) noexcept;
  void update_force() noexcept;
  void fade(double towards) noexcept;
  HapticCycle finish(CycleStatus status, Status step) const noexcept;

  MotionConstraint guard_;
  HapticOptions options_;
  double longest_;  // the longest motion of the proxy in a cycle [length]
  PassivityObserver passivity_;
  EnergyReport energy_;
  HeldForce held_;  // the forces since the last cycle
  Vec3 proxy_ = Vec3::Zero();
  Vec3 hand_ = Vec3::Zero();                  // the last measured position
  Vec3 hand_way_ = Vec3::Zero();              // displacement in the last cycle; zero if not known
  double stretch_ = 0.0;                      // between proxy and hand in the last cycle [length]
  double rate_ = 0.0;                         // of the stretch [length / s]
  double share_ = 1.0;                        // the fraction of the force that has not faded
  std::span<const GuideState> guide_states_;  // of the last step of guard_
  bool engaged_ = false;
  bool seen_ = false;  // true if the hand was measured in the last cycle
};

}  // namespace keepout
