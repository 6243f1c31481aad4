// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "keepout/control/cycle_status.h"
#include "keepout/control/haptic_force.h"
#include "keepout/step/motion_constraint.h"

namespace keepout {

/// The result of a cycle.
struct HapticCycle {
  CycleStatus status = CycleStatus::not_engaged;  // the outcome of the cycle
  Status step = Status::invalid_input;  // of the motion constraint; only if guarded or stopped
  Limits limits = {};                   // the limits of the step
  Vec3 proxy = Vec3::Zero();            // the target position of the tool [length]
  Vec3 force = Vec3::Zero();            // on the hand until the next cycle [N]
  Subject subject = Subject::tip;       // what the proxy moves

  /// Returns true if the proxy has moved by the step.
  bool ok() const noexcept { return is_ok(status); }
  /// Returns one line on what happened and what to do about it; for a stopped cycle, the reason of
  /// the step.
  std::string_view reason() const noexcept {
    return status == CycleStatus::stopped ? keepout::reason(step, subject)
                                          : keepout::reason(status);
  }
};

/// A proxy of the operator's hand that stays out of the mesh, and the force that pulls the hand to
/// it. It is the god-object of Zilles and Salisbury (1995) with the certified step as its
/// constraint. All values are in the frame and the unit of the mesh. Not thread-safe. A cycle does
/// not allocate, lock or throw.
///
/// If a cycle fails, the proxy does not move, and the force fades: see HapticForce.
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

  /// Releases, and continues with another mesh: see MotionConstraint::follow. Allocates.
  void follow(std::shared_ptr<const Mesh> mesh, std::shared_ptr<const SpatialIndex> index);

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
  const EnergyReport& energy() const noexcept { return force_.energy(); }
  /// Returns the options.
  const HapticOptions& options() const noexcept { return options_; }
  /// Returns the mesh.
  const Mesh& mesh() const noexcept { return guard_.mesh(); }

 private:
  HapticCycle finish(CycleStatus status, Status step) const noexcept;

  MotionConstraint guard_;
  HapticOptions options_;
  double longest_;  // the longest motion of the proxy in a cycle [length]
  HapticForce force_;
  Vec3 proxy_ = Vec3::Zero();
  std::span<const GuideState> guide_states_;  // of the last step of guard_
  bool engaged_ = false;
};

}  // namespace keepout
