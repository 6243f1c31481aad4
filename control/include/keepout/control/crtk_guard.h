// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "keepout/control/haptic_proxy.h"
#include "keepout/control/registration.h"

namespace keepout {

/// How a CrtkGuard behaves; what it takes lengths in is said at each.
struct CrtkOptions {
  HapticOptions haptic = {};  // on the side of the robot, in the unit of the mesh
  /// How far the robot goes for the way of the hand, as set in the teleoperation. The force on the
  /// hand is that on the tool times this, so that what one side puts in is what the other gets out.
  double motion_scale = 1.0;                // > 0
  Mat3 hand_from_robot = Mat3::Identity();  // turns a force into the frame of the hand's device
  double longest_silence = 0.02;            // for which the last goal stands [s], >= 0
  double farthest_lag = 5.0;                // of the robot behind its setpoint [length], > 0
  double farthest_start = 1000.0;  // from the box around the mesh, on engaging [length], > 0
};

/// A force and a torque. [N], [N length]
struct Wrench {
  Vec3 force = Vec3::Zero();   // [N]
  Vec3 torque = Vec3::Zero();  // [N length]
};

/// A motion constraint under the names of CRTK, the convention that the da Vinci Research Kit
/// follows: stands between the teleoperation, which computes a goal for the robot, and the robot.
/// docs/controllers.md says where to plug it in. Poses are in the robot's frame and unit.
///
///     guard.engage(robot.setpoint_cp());               // at the start, and after clutching
///     each cycle:
///       guard.measured_cp(robot.measured_cp());
///       guard.servo_cp(goal);                          // or await_cp(), when none came
///       robot.servo_cp(*guard.setpoint_cp());
///       hand.servo_cf(guard.servo_cf());
///
/// The tip is guarded: a point, or the ball of the motion constraint's tool radius. The orientation
/// passes through as it is, so the shaft is free to sweep: give the ball the size of what turns.
///
/// Not thread-safe; nothing here allocates, locks or throws once it is built.
class CrtkGuard {
 public:
  /// Throws Error for an option out of range.
  CrtkGuard(MotionConstraint guard, const Registration& registration, const CrtkOptions& options);

  /// Begins at where the robot is: its setpoint, so that it does not jump. guarded, invalid_pose or
  /// far_from_mesh; after those it is not engaged.
  CycleStatus engage(const Pose& setpoint) noexcept;

  /// Lets go, as when the clutch is pressed: no setpoint, no force.
  void release() noexcept;

  /// Lets go, and takes another registration, as when the camera has moved. Builds nothing.
  void set_registration(const Registration& registration) noexcept;

  /// Where the robot is, for the next cycle to compare with where it was sent.
  void measured_cp(const Pose& pose) noexcept { measured_ = pose; }

  /// One cycle towards a goal.
  CycleStatus servo_cp(const Pose& goal) noexcept;

  /// One cycle in which no goal came: the last one stands, but not for longer than longest_silence.
  CycleStatus await_cp() noexcept;

  /// What to send to the robot, whatever the status: after a failed cycle it is the last one, with
  /// its orientation. Nothing unless engaged.
  const std::optional<Pose>& setpoint_cp() const noexcept { return setpoint_; }

  /// What to send to the hand's device, in its frame; without torque.
  const Wrench& servo_cf() const noexcept { return wrench_; }

  /// The last cycle, in the frame of the mesh.
  const HapticCycle& cycle() const noexcept { return cycle_; }
  /// One line on the last cycle, and what to do about it; a literal.
  std::string_view reason() const noexcept { return cycle_.reason(); }

  /// What went to and fro since it was engaged.
  const EnergyReport& energy() const noexcept { return proxy_.energy(); }
  /// Between the robot's frame and that of the mesh.
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
