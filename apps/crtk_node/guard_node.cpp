// SPDX-License-Identifier: BSD-3-Clause
#include "guard_node.h"

#include <algorithm>

namespace keepout::crtk {
namespace {

constexpr double report_period = 1.0 / 30.0;  // of reasons and shapes [s]

std::span<const double> span_of(const Numbers& numbers) { return {numbers.data, numbers.size}; }

Message message_of(const Pose& pose, double now, std::string_view frame) {
  const Quaternion q = to_quaternion(pose.rotation);
  return {.stamp = now,
          .frame = frame,
          .vector = {pose.position.x(), pose.position.y(), pose.position.z()},
          .rotation = {q.x, q.y, q.z, q.w}};
}

}  // namespace

GuardNode::GuardNode(const Settings& settings, const Scene& scene, Transport& transport)
    : settings_(settings),
      transport_(transport),
      session_(make_session(settings, scene)),
      drives_joints_(session_.instrument() != nullptr) {
  for (int k = 1; drives_joints_ && k <= session_.instrument()->chain().size(); ++k) {
    names_.first[names_.count++] = session_.instrument()->chain().joint(k).name;
  }
  const auto of_robot = [&](const char* command, Kind kind) {
    return transport.subscribe(settings.of_robot(command), kind);
  };
  const auto of_operator = [&](const char* command, Kind kind) {
    return transport.subscribe(settings.of_guard(command), kind);
  };
  measured_cp_ = of_robot("measured_cp", Kind::pose);
  measured_js_ = of_robot("measured_js", Kind::joints);
  setpoint_cp_ = of_robot("setpoint_cp", Kind::pose);
  setpoint_js_ = of_robot("setpoint_js", Kind::joints);
  operating_state_ = of_robot("operating_state", Kind::state);
  // Only to see who else publishes them.
  robot_commands_ = {of_robot("servo_cp", Kind::pose), of_robot("servo_jp", Kind::joints)};
  servo_cp_ = of_operator("servo_cp", Kind::pose);
  servo_jp_ = of_operator("servo_jp", Kind::joints);
  servo_jv_ = of_operator("servo_jv", Kind::joints);
  engage_ = of_operator("engage", Kind::flag);

  command_ = drives_joints_ ? transport.advertise(settings.of_robot("servo_jp"), Kind::joints)
                            : transport.advertise(settings.of_robot("servo_cp"), Kind::pose);
  if (!settings.hand.empty()) {
    hand_ = transport.advertise("/" + settings.hand + "/servo_cf", Kind::wrench);
  }
  measured_out_ = transport.advertise(settings.of_guard("measured_cp"), Kind::pose);
  setpoint_out_ = transport.advertise(settings.of_guard("setpoint_cp"), Kind::pose);
  state_out_ = transport.advertise(settings.of_guard("operating_state"), Kind::state, true);
  reason_out_ = transport.advertise(settings.of_guard("reason"), Kind::text, true);
  if (!drives_joints_) {
    drawing_.emplace(make_tip_guard(settings, scene), scene.registration, settings.frame,
                     settings.of_guard("shapes"), transport);
  }
}

void GuardNode::receive(int topic, const Message& message) {
  if (topic == measured_cp_ || topic == setpoint_cp_ || topic == servo_cp_) {
    receive_pose(topic, message);
  } else if (topic == measured_js_ || topic == setpoint_js_ || topic == servo_jp_ ||
             topic == servo_jv_) {
    receive_joints(topic, message);
  } else if (topic == operating_state_) {
    const auto state = operating_state_of(message.text);
    session_.on_operating_state(state.value_or(OperatingState::fault), message.flag);
  } else if (topic == engage_) {
    is_asked_ = message.flag;
    if (!message.flag) session_.release();
  }
}

void GuardNode::receive_pose(int topic, const Message& message) {
  const auto& [x, y, z, w] = message.rotation;
  const auto rotation = to_rotation({x, y, z, w});
  if (!rotation) return session_.refuse(CycleStatus::invalid_pose);
  const auto& at = message.vector;
  const Pose pose{Vec3(at[0], at[1], at[2]), *rotation};
  const MessageHeader header{message.stamp, message.frame};
  if (topic == measured_cp_) {
    session_.on_measured_cp(pose, header);
  } else if (topic == setpoint_cp_) {
    session_.on_setpoint_cp(pose, header);
  } else {
    goal_ = pose.position;
    session_.on_servo_cp(pose, header);
  }
}

/// Returns true if a message states other joints than those of the chain, or in another order.
bool GuardNode::has_other_joints(const Names& names) const {
  return names.count != 0 && (names.count != names_.count || names.first != names_.first);
}

void GuardNode::receive_joints(int topic, const Message& message) {
  if (has_other_joints(message.names)) return session_.refuse(CycleStatus::wrong_command);
  const MessageHeader header{message.stamp, message.frame};
  if (topic == measured_js_) {
    session_.on_measured_js(span_of(message.positions), header);
  } else if (topic == setpoint_js_) {
    session_.on_setpoint_js(span_of(message.positions), header);
  } else if (topic == servo_jp_) {
    session_.on_servo_jp(span_of(message.positions), header);
  } else {
    session_.on_servo_jv(span_of(message.velocities), header);
  }
}

void GuardNode::cycle(double now) {
  transport_.deliver(*this);
  const auto has_more_than = [&](int count) {
    return [this, count](int topic) { return transport_.publishers(topic) > count; };
  };
  const std::array goals{servo_cp_, servo_jp_, servo_jv_};
  const bool is_contested = std::ranges::any_of(robot_commands_, has_more_than(0)) ||
                            std::ranges::any_of(goals, has_more_than(1));
  session_.on_contest(is_contested);
  CycleStatus status = CycleStatus::guarded;
  if (is_asked_ && !session_.engaged()) status = session_.engage(now);
  is_asked_ = false;
  // After a failed engage(), the reason is that of engage().
  if (is_ok(status)) status = session_.tick(now);
  ++counts_[std::min<std::size_t>(static_cast<std::size_t>(status), counts_.size() - 1)];
  // The cause of a failed engage() is not replaced by its consequence.
  if (!is_ok(status) && (status != CycleStatus::not_engaged || is_ok(status_))) {
    status_ = status;
    reason_ = session_.reason();
  }
  // Two senders would move the robot to and fro.
  if (session_.engaged() && status != CycleStatus::contested) send_setpoint(now);
  send_to_teleoperation(now);
  if (now >= next_report_) report(now);
}

void GuardNode::send_setpoint(double now) {
  if (drives_joints_) {
    const std::span<const double> positions = session_.setpoint_jp();
    transport_.send(command_, {.stamp = now,
                               .frame = settings_.frame,
                               .names = names_,
                               .positions = {positions.data(), positions.size()}});
  } else {
    transport_.send(command_, message_of(*session_.setpoint_cp(), now, settings_.frame));
  }
}

void GuardNode::send_to_teleoperation(double now) {
  const OperatingState state = session_.operating_state();
  const bool is_homed = state == OperatingState::enabled || state == OperatingState::paused;
  if (state != sent_state_ &&
      transport_.send(state_out_, {.stamp = now, .text = name(state), .flag = is_homed})) {
    sent_state_ = state;
  }
  if (const auto& measured = session_.measured_cp()) {
    transport_.send(measured_out_, message_of(*measured, now, settings_.frame));
  }
  if (const auto& setpoint = session_.setpoint_cp()) {
    transport_.send(setpoint_out_, message_of(*setpoint, now, settings_.frame));
  }
  if (hand_ >= 0) {
    const Vec3& force = session_.servo_cf().force;
    transport_.send(hand_, {.stamp = now, .vector = {force.x(), force.y(), force.z()}});
  }
}

/// Sends the reason of the last failed cycle since the last report, if it is another one.
void GuardNode::report(double now) {
  next_report_ = now + report_period;
  if (is_ok(status_)) reason_ = session_.reason();
  if (reason_ != sent_reason_) {
    std::string text(name(status_));
    text.append(": ").append(reason_);
    if (transport_.send(reason_out_, {.text = text})) sent_reason_ = reason_;
  }
  status_ = CycleStatus::guarded;
  if (drawing_ && session_.engaged()) {
    drawing_->draw(session_.cycle().proxy, session_.registration().point_to_mesh(goal_));
  }
}

std::string GuardNode::summary() const {
  std::string text = "cycles by status:";
  for (std::size_t status = 0; status < counts_.size(); ++status) {
    if (counts_[status] == 0) continue;
    text += " " + std::string(name(static_cast<CycleStatus>(status))) + " " +
            std::to_string(counts_[status]);
  }
  return text;
}

}  // namespace keepout::crtk
