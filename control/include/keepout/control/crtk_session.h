// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "keepout/control/haptic_proxy.h"
#include "keepout/control/instrument_proxy.h"
#include "keepout/control/registration.h"

namespace keepout {

/// The states of a robot in CRTK (Collaborative Robotics Toolkit).
enum class OperatingState : std::uint8_t { disabled, enabled, paused, fault };

/// Returns the state's name in CRTK, for example "ENABLED".
std::string_view name(OperatingState state) noexcept;

/// Returns the state of a name in CRTK; empty for another text.
std::optional<OperatingState> operating_state_of(std::string_view name) noexcept;

/// The time and the frame of a message.
struct MessageHeader {
  double stamp;                 // when it was sent, by the clock of CrtkSession::tick [s]
  std::string_view frame = {};  // of its poses; empty: not stated, and accepted
};

/// A force and a torque.
struct Wrench {
  Vec3 force = Vec3::Zero();   // [N]
  Vec3 torque = Vec3::Zero();  // [N length]
};

/// The options of a CrtkSession. Lengths are in the unit of the mesh.
struct CrtkOptions {
  HapticOptions haptic = {};  // of the proxy, which the robot follows
  /// The displacement of the robot divided by that of the hand, as set in the teleoperation. The
  /// force on the hand is the force on the tool times this factor, so that both sides exchange the
  /// same energy.
  double motion_scale = 1.0;                // > 0
  Mat3 hand_from_robot = Mat3::Identity();  // rotates a force into the frame of the hand's device
  double longest_silence = 0.02;   // goals and measurements are used for this time [s], >= 0
  double farthest_lag = 5.0;       // largest distance from setpoint to robot [length], > 0
  double farthest_start = 1000.0;  // from the mesh's bounds at engage() [length], > 0
  std::string frame = {};          // of the robot's poses; empty: any
  /// True if the robot must report that it is enabled and homed, and must be measured. False for a
  /// robot without feedback: it then follows unobserved.
  /// A state that it does report counts in any case.
  bool needs_feedback = true;
};

/// A motion constraint between a teleoperation and a robot, with the interface of CRTK, the
/// convention of the da Vinci Research Kit. The teleoperation sends its goals to this object, which
/// sends setpoints to the robot (see docs/controllers.md). It drives a tip or a whole instrument.
/// Poses are in the robot's frame and unit, joints in the order of the chain, rotations in radians
/// and prismatic positions in the robot's unit.
///
///     session.engage(now);                         // at the start, and after clutching
///     each cycle:
///       session.on_measured_cp(...), session.on_servo_cp(...)    // what has arrived
///       session.tick(now);
///       robot.servo_cp(*session.setpoint_cp());
///       hand.servo_cf(session.servo_cf());
///
/// The functions on_...() are mailboxes: the last valid message counts. After a message that is
/// refused, the next tick stands still, and engage() fails, with its cause. This is so also if a
/// valid one follows.
///
/// A session of a tip constrains a point, or a ball of the motion constraint's tool radius. The
/// orientation is passed on unchanged, so the shaft may rotate freely. The ball must contain all
/// parts that rotate. A session of an instrument constrains all its bodies.
///
/// Not thread-safe: transports call it from one thread. Except set_mesh(), no function allocates,
/// locks or throws. The source of a move may only be destroyed or assigned to.
class CrtkSession {
 public:
  /// Makes the session of a tip. Throws Error for an option out of range, and for the constraint of
  /// a convex tool, which would not turn with the robot.
  CrtkSession(MotionConstraint guard, const Registration& registration, const CrtkOptions& options);
  /// Makes the session of an instrument. The chain's world is the robot's frame, in the unit of the
  /// mesh: all meshes are placed at their registered pose. Throws Error for an option out of range,
  /// and for a joint without a limit of its velocity or increment.
  CrtkSession(InstrumentConstraint guard, const Registration& registration,
              const CrtkOptions& options);

  /// Receives the state of the robot.
  void on_operating_state(OperatingState state, bool is_homed) noexcept;
  /// Receives the measured pose of the tool; only a session of a tip uses it.
  void on_measured_cp(const Pose& pose, const MessageHeader& header) noexcept;
  /// Receives the measured positions (n) of the joints; only a session of an instrument uses them.
  void on_measured_js(std::span<const double> positions, const MessageHeader& header) noexcept;
  /// Receives the robot's own setpoint, where engage() starts; only a session of a tip uses it.
  void on_setpoint_cp(const Pose& pose, const MessageHeader& header) noexcept;
  /// Receives the robot's own setpoint of the joints (n), where engage() starts; only a session of
  /// an instrument uses it.
  void on_setpoint_js(std::span<const double> positions, const MessageHeader& header) noexcept;
  /// Receives a goal for the pose of the tool.
  void on_servo_cp(const Pose& goal, const MessageHeader& header) noexcept;
  /// Receives a goal for the positions (n) of the joints: only a session of an instrument takes it.
  void on_servo_jp(std::span<const double> goal, const MessageHeader& header) noexcept;
  /// Receives a velocity (n) of the joints, per second: only a session of an instrument takes it.
  void on_servo_jv(std::span<const double> velocity, const MessageHeader& header) noexcept;
  /// Sets whether somebody else commands the robot. While true, the tool stands still.
  void on_contest(bool is_contested) noexcept { is_contested_ = is_contested; }
  /// Refuses a message that its transport found wrong. The next tick stands still with the cause.
  void refuse(CycleStatus why) noexcept;

  /// Engages at the robot's own setpoint, so that the robot does not jump. Returns guarded. On
  /// failure it does not engage, and returns the cause. The message of that setpoint must not be
  /// older than the last setpoint that the session has sent. `now`: the time [s].
  CycleStatus engage(double now) noexcept;

  /// Releases, for example when the clutch is pressed. There is then no setpoint and no force.
  void release() noexcept;

  /// Releases, and replaces the registration, for example after the camera has moved. The index is
  /// not rebuilt. Messages that have arrived before are forgotten.
  void set_registration(const Registration& registration) noexcept;

  /// Continues with another mesh of the tip's constraint, or the first mesh of the instrument's,
  /// and releases. Throws Error, and changes nothing, if the index is for another mesh. Allocates.
  void set_mesh(std::shared_ptr<const Mesh> mesh, std::shared_ptr<const SpatialIndex> index);

  /// Runs one cycle towards the last goal. Call it once each period. A robot that is no longer
  /// enabled and homed releases the session. `now`: the time [s].
  CycleStatus tick(double now) noexcept;

  /// Returns the setpoint to send to the robot for any status: after a failed cycle, the last pose.
  /// Empty unless engaged.
  const std::optional<Pose>& setpoint_cp() const noexcept { return setpoint_; }
  /// Returns the positions (n) to send to the robot for any status. Empty unless engaged, and in a
  /// session of a tip.
  std::span<const double> setpoint_jp() const noexcept;
  /// Returns the measured pose of the tool; empty before the first one.
  const std::optional<Pose>& measured_cp() const noexcept { return measured_; }
  /// Returns the wrench to send to the hand's device, in its frame; the torque is zero.
  const Wrench& servo_cf() const noexcept { return wrench_; }
  /// Returns the state to report to the teleoperation: that of the robot; paused if the session of
  /// an enabled robot is not engaged.
  OperatingState operating_state() const noexcept;

  /// Returns true if the session is engaged.
  bool engaged() const noexcept { return setpoint_.has_value(); }
  /// Returns the result of the last cycle: in the frame of the mesh for a tip, and in the robot's
  /// frame and the unit of the mesh for an instrument.
  const HapticCycle& cycle() const noexcept { return cycle_; }
  /// Returns one line on the last cycle and what to do about it; a string literal.
  std::string_view reason() const noexcept { return cycle_.reason(); }

  /// Returns the energies since the session was engaged.
  const EnergyReport& energy() const noexcept;
  /// Returns the registration between the robot's frame and that of the mesh.
  const Registration& registration() const noexcept { return registration_; }
  /// Returns the proxy of a tip; null in a session of an instrument.
  const HapticProxy* tip() const noexcept { return std::get_if<HapticProxy>(&proxy_); }
  /// Returns the proxy of an instrument; null in a session of a tip.
  const InstrumentProxy* instrument() const noexcept {
    return std::get_if<InstrumentProxy>(&proxy_);
  }

 private:
  using Positions = std::array<double, Chain::most_joints>;
  enum class Command : std::uint8_t { pose, positions, velocities };

  bool is_ready() const noexcept;
  bool is_fresh(double stamp, double now) const noexcept;
  /// Returns true for a pose in the session's frame; refuses others.
  bool is_accepted(const Pose& pose, const MessageHeader& header) noexcept;
  /// Stores the numbers of joints, in the unit of the mesh. Returns false for others than n finite
  /// numbers, and refuses them.
  bool take(std::span<const double> numbers, Positions& joints) noexcept;
  void receive_joints(std::span<const double> numbers, double stamp, Command command) noexcept;
  /// Returns the positions (n) that the session stores in `joints`.
  std::span<const double> all(const Positions& joints) const noexcept;
  /// Returns the number of mesh units in the robot's unit of a joint: 1 if it is an angle.
  double scale_of(std::size_t joint) const noexcept;
  /// Returns the position of the tool of a pose, in the frame of the proxy.
  Vec3 position_of(const Pose& pose) const noexcept;
  /// Returns the distance from the setpoint to the measured robot. [length]
  double lag() const noexcept;
  /// Returns the mesh of a tip, or the first mesh of an instrument; null without a mesh.
  const Mesh* first_mesh() const noexcept;
  HapticCycle move() noexcept;
  HapticCycle stand(CycleStatus why) noexcept;
  CycleStatus finish(const HapticCycle& cycle) noexcept;

  std::variant<HapticProxy, InstrumentProxy> proxy_;
  Registration registration_;
  CrtkOptions options_;
  // The mailboxes. Stamps begin in the infinite past; joints are in the unit of the mesh.
  static constexpr double never = -std::numeric_limits<double>::infinity();
  std::optional<OperatingState> robot_state_;
  bool is_homed_ = false;
  bool is_contested_ = false;
  CycleStatus refusal_ = CycleStatus::guarded;  // guarded: nothing was refused since the last tick
  std::optional<Pose> measured_;
  Positions measured_joints_ = {};
  double measured_stamp_ = never;
  Pose start_;  // the robot's own setpoint
  Positions start_joints_ = {};
  double start_stamp_ = never;
  double sent_ = never;              // when the session has last sent a setpoint [s]
  Command command_ = Command::pose;  // the kind of the last goal
  Pose goal_;
  Positions goal_joints_ = {};  // positions, or velocities
  double goal_stamp_ = never;
  // The results.
  std::optional<Pose> setpoint_;
  Positions setpoint_joints_ = {};  // in the unit of the robot
  Wrench wrench_;
  HapticCycle cycle_;
};

}  // namespace keepout
