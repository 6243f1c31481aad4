// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drawing.h"
#include "keepout/control/crtk_session.h"
#include "node.h"
#include "settings.h"

namespace keepout::crtk {

/// Connects a CrtkSession to the topics of a robot and of a teleoperation. docs/ros1.md lists the
/// topics. A cycle passes the messages that have arrived to the session, ticks it, and sends the
/// setpoint.
class GuardNode final : public Node {
 public:
  /// Subscribes and announces. `transport` must outlive the node. Throws Error.
  GuardNode(const Settings& settings, const Scene& scene, Transport& transport);

  GuardNode(const GuardNode&) = delete;
  GuardNode& operator=(const GuardNode&) = delete;

  void receive(int topic, const Message& message) override;
  void cycle(double now) override;
  std::string summary() const override;

 private:
  void receive_pose(int topic, const Message& message);
  void receive_joints(int topic, const Message& message);
  bool has_other_joints(const Names& names) const;
  void send_setpoint(double now);
  void send_to_teleoperation(double now);
  void report(double now);

  Settings settings_;
  Transport& transport_;
  CrtkSession session_;
  bool drives_joints_;
  Names names_;  // of the joints of the session's chain
  // Subscriptions.
  int measured_cp_, measured_js_, setpoint_cp_, setpoint_js_, operating_state_;
  int servo_cp_, servo_jp_, servo_jv_, engage_;
  std::array<int, 2> robot_commands_;  // of the robot: servo_cp, servo_jp
  // Announcements.
  int command_, hand_ = -1, measured_out_, setpoint_out_, state_out_, reason_out_;
  std::optional<Drawing> drawing_;  // of a tip

  bool is_asked_ = false;                      // to engage in the next cycle
  Vec3 goal_ = Vec3::Zero();                   // of the teleoperation, in the robot's frame [m]
  CycleStatus status_ = CycleStatus::guarded;  // the last failure since a reason was sent
  std::string_view reason_ = {};               // its reason
  std::string_view sent_reason_ = {};          // the reason that was sent
  std::optional<OperatingState> sent_state_;   // the state that was sent
  double next_report_ = 0.0;                   // when reasons and shapes are due [s]
  std::array<std::uint64_t, 16> counts_ = {};  // of cycles, by CycleStatus
};

}  // namespace keepout::crtk
