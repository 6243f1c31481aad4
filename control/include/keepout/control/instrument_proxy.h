// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>
#include <span>

#include "keepout/control/haptic_proxy.h"
#include "keepout/robot/instrument_constraint.h"

namespace keepout {

/// Like HapticProxy for a whole instrument: the joint positions that the robot is sent to, and the
/// force that pulls the hand to the flange. Poses are in the world of the chain, lengths in the
/// unit of the mesh. Not thread-safe. A cycle does not allocate, lock or throw.
///
/// HapticOptions::top_speed limits the desired motion of the flange in a cycle. A rotation of 1 rad
/// counts like a displacement of InstrumentOptions::orientation_weight. The limits of the joints
/// limit their speeds. `HapticOptions::guides` must be empty: an instrument has those
/// of InstrumentConstraint::set_guides. A cycle that stands still does not retreat from a mesh that
/// moves.
class InstrumentProxy {
 public:
  /// Makes a proxy. The recovery of the guard is limited to top_speed * period. Throws Error for an
  /// option out of range, for guides in the options, and unless the period is that of the guard.
  /// Also throws Error for a joint without a limit of its velocity or increment.
  InstrumentProxy(InstrumentConstraint guard, const HapticOptions& options);

  /// Sets proxy and hand to a configuration q (n): see HapticProxy::engage. Returns invalid_pose
  /// for another number of joints, or for a number that is not finite.
  CycleStatus engage(std::span<const double> q) noexcept;
  /// See HapticProxy::release.
  void release() noexcept;

  /// Releases, and places all meshes at a pose: see InstrumentConstraint::place.
  void place(const Pose& pose) noexcept;
  /// Releases, and continues with another first mesh: see InstrumentConstraint::follow. Allocates.
  void follow(std::shared_ptr<const Mesh> mesh, std::shared_ptr<const SpatialIndex> index);

  /// Runs one cycle: moves the flange towards a pose as far as limits and meshes allow.
  HapticCycle cycle(const Pose& goal) noexcept;
  /// Runs one cycle: moves the joints towards a configuration (n). The hand is at its flange.
  HapticCycle cycle(std::span<const double> goal) noexcept;
  /// Runs one cycle: moves the joints by an increment (n). There is no hand: the force fades.
  HapticCycle move_by(std::span<const double> increment) noexcept;

  /// See HapticProxy::stand.
  HapticCycle stand(CycleStatus why) noexcept;
  /// See HapticProxy::stand. `hand`: the position of the goal [length].
  HapticCycle stand(CycleStatus why, const Vec3& hand) noexcept;

  /// Returns the positions (n) of the joints, to which the robot is sent. [rad or length]
  std::span<const double> positions() const noexcept {
    return {positions_.data(), static_cast<std::size_t>(chain().size())};
  }
  /// Returns the pose of the flange at these positions.
  const Pose& flange() const noexcept { return flange_; }
  /// Returns the pose of the flange at other positions (n). Precondition: n finite numbers.
  Pose flange_at(std::span<const double> q) const noexcept;
  /// Returns the largest distance of a body's point at other positions (n) from where it is at
  /// positions(). Precondition: n finite numbers. [length]
  double lag(std::span<const double> q) const noexcept;
  /// Returns the chain.
  const Chain& chain() const noexcept { return guard_.instrument().chain(); }

  /// Returns true if the proxy was engaged and not released since.
  bool engaged() const noexcept { return engaged_; }
  /// Returns the constraint.
  const InstrumentConstraint& guard() const noexcept { return guard_; }
  /// Returns the energies since the proxy was engaged.
  const EnergyReport& energy() const noexcept { return force_.energy(); }
  /// Returns the options.
  const HapticOptions& options() const noexcept { return options_; }

 private:
  /// Adds a step with motion to the positions.
  void move(const InstrumentStep& step) noexcept;
  /// Ends a cycle with the result of its step; the force and the positions are already updated.
  HapticCycle finish(const InstrumentStep& step) const noexcept;
  HapticCycle finish(CycleStatus status, Status step) const noexcept;

  InstrumentConstraint guard_;
  HapticOptions options_;
  HapticForce force_;
  std::array<double, Chain::most_joints> positions_ = {};
  Pose flange_;  // at the positions
  bool engaged_ = false;
};

}  // namespace keepout
