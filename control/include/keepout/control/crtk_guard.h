// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "keepout/control/haptic_proxy.h"
#include "keepout/control/registration.h"

namespace keepout {

/// The options of a CrtkGuard. Lengths are in the unit of the mesh.
struct CrtkOptions {
  HapticOptions haptic = {};  // of the proxy, which the robot follows
  /// The displacement of the robot divided by that of the hand, as set in the teleoperation. The
  /// force on the hand is the force on the tool times this factor, so that both sides exchange the
  /// same energy.
  double motion_scale = 1.0;                // > 0
  Mat3 hand_from_robot = Mat3::Identity();  // rotates a force into the frame of the hand's device
  double longest_silence = 0.02;            // the last goal is used for this time [s], >= 0
  double farthest_lag = 5.0;                // largest distance from setpoint to robot [length], > 0
  double farthest_start = 1000.0;           // from the mesh's bounds at engage() [length], > 0
};

/// A force and a torque. [N], [N length]
struct Wrench {
  Vec3 force = Vec3::Zero();   // [N]
  Vec3 torque = Vec3::Zero();  // [N length]
};

/// A motion constraint with the interface of CRTK (Collaborative Robotics Toolkit), the convention
/// of the da Vinci Research Kit. The teleoperation sends its goals to this object, which sends
/// setpoints to the robot (see docs/controllers.md). Poses are in the robot's frame and unit.
///
///     guard.engage(robot.setpoint_cp());               // at the start, and after clutching
///     each cycle:
///       guard.measured_cp(robot.measured_cp());
///       guard.servo_cp(goal);                          // or await_cp() without a new goal
///       robot.servo_cp(*guard.setpoint_cp());
///       hand.servo_cf(guard.servo_cf());
///
/// Only the tip is constrained: a point, or a ball of the motion constraint's tool radius. The
/// orientation is passed on unchanged, so the shaft may rotate freely. The ball must contain all
/// parts that rotate.
///
/// Not thread-safe. After construction no function allocates, locks or throws.
class CrtkGuard {
 public:
  /// Makes the guard. Throws Error for an option out of range.
  CrtkGuard(MotionConstraint guard, const Registration& registration, const CrtkOptions& options);

  /// Engages at the robot's setpoint, so that the robot does not jump. Returns guarded. On failure
  /// it does not engage, and returns invalid_pose or far_from_mesh.
  CycleStatus engage(const Pose& setpoint) noexcept;

  /// Releases, for example when the clutch is pressed. There is then no setpoint and no force.
  void release() noexcept;

  /// Releases, and replaces the registration, for example after the camera has moved. The index is
  /// not rebuilt.
  void set_registration(const Registration& registration) noexcept;

  /// Sets the measured pose of the robot. The next cycle compares it with the setpoint.
  void measured_cp(const Pose& pose) noexcept { measured_ = pose; }

  /// Runs one cycle towards a goal.
  CycleStatus servo_cp(const Pose& goal) noexcept;

  /// Runs one cycle without a new goal: uses the last goal for at most longest_silence.
  CycleStatus await_cp() noexcept;

  /// Returns the setpoint to send to the robot for any status: after a failed cycle, the last pose.
  /// Empty unless engaged.
  const std::optional<Pose>& setpoint_cp() const noexcept { return setpoint_; }

  /// Returns the wrench to send to the hand's device, in its frame; the torque is zero.
  const Wrench& servo_cf() const noexcept { return wrench_; }

  /// Returns the result of the last cycle, in the frame of the mesh.
  const HapticCycle& cycle() const noexcept { return cycle_; }
  /// Returns one line on the last cycle and what to do about it; a string literal.
  std::string_view reason() const noexcept { return cycle_.reason(); }

  /// Returns the energies since the guard was engaged.
  const EnergyReport& energy() const noexcept { return proxy_.energy(); }
  /// Returns the registration between the robot's frame and that of the mesh.
  const Registration& registration() const noexcept { return registration_; }

 private:
  CycleStatus go() noexcept;
  CycleStatus take(const HapticCycle& cycle) noexcept;

  HapticProxy proxy_;
  Registration registration_;
  CrtkOptions options_;
  std::optional<Pose> setpoint_;
  Wrench wrench_;
  HapticCycle cycle_;
  Pose goal_;
  std::optional<Pose> measured_;  // since the last cycle
  double silence_ = 0.0;          // [s]
};

}  // namespace keepout
