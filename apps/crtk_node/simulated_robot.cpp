// SPDX-License-Identifier: BSD-3-Clause
#include "simulated_robot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace keepout::crtk {
namespace {

constexpr double way = 10.0;   // down and sideways [mm]
constexpr double above = 5.0;  // of the start above the highest vertex [mm]
constexpr double wait = 0.5;   // between two requests to engage [s]

}  // namespace

SimulatedRobot::SimulatedRobot(const Settings& settings, const Scene& scene, Transport& transport)
    : settings_(settings),
      scene_(scene),
      transport_(transport),
      nearest_triangle_(*scene_.mesh, *scene_.index) {
  servo_cp_ = transport.subscribe(settings.of_robot("servo_cp"), Kind::pose);
  state_in_ = transport.subscribe(settings.of_guard("operating_state"), Kind::state);
  reason_in_ = transport.subscribe(settings.of_guard("reason"), Kind::text);
  measured_cp_ = transport.advertise(settings.of_robot("measured_cp"), Kind::pose);
  setpoint_cp_ = transport.advertise(settings.of_robot("setpoint_cp"), Kind::pose);
  state_out_ = transport.advertise(settings.of_robot("operating_state"), Kind::state, true);
  goal_out_ = transport.advertise(settings.of_guard("servo_cp"), Kind::pose);
  engage_ = transport.advertise(settings.of_guard("engage"), Kind::flag);
  const Vec3 highest = *std::ranges::max_element(scene.mesh->vertices(), {},
                                                 [](const Vec3& vertex) { return vertex.z(); });
  start_ = highest + Vec3(0, 0, settings.tool_radius + settings.margin + above);
  position_ = scene.registration.point_to_robot(start_);
}

void SimulatedRobot::receive(int topic, const Message& message) {
  if (topic == servo_cp_) {
    position_ = Vec3(message.vector[0], message.vector[1], message.vector[2]);
    const Vec3 point = scene_.registration.point_to_mesh(position_);
    nearest_ = std::min(nearest_, nearest_triangle_(point).closest.offset.norm());
    ++setpoints_;
  } else if (topic == state_in_) {
    is_engaged_ = message.text == "ENABLED";
  } else if (topic == reason_in_) {
    ++reasons_[std::string(message.text)];
  }
}

/// Returns the position of the goal: a second down, one sideways, one up and one back. [mm]
Vec3 SimulatedRobot::goal_at(double seconds) const {
  const double t = std::fmod(seconds, 4.0);
  const double down = std::min(t, 1.0) - std::clamp(t - 2.0, 0.0, 1.0);
  const double sideways = std::clamp(t - 1.0, 0.0, 1.0) - std::clamp(t - 3.0, 0.0, 1.0);
  return start_ + Vec3(way * sideways, 0.0, -way * down);
}

void SimulatedRobot::send_pose(int topic, const Vec3& point, double now) {
  transport_.send(topic, {.stamp = now,
                          .frame = settings_.frame,
                          .vector = {point.x(), point.y(), point.z()},
                          .rotation = {0.0, 0.0, 0.0, 1.0}});
}

void SimulatedRobot::cycle(double now) {
  transport_.deliver(*this);
  if (next_ask_ == 0.0) {
    transport_.send(state_out_, {.stamp = now, .text = "ENABLED", .flag = true});
    next_ask_ = now + wait;
  }
  send_pose(measured_cp_, position_, now);
  send_pose(setpoint_cp_, position_, now);
  if (!is_engaged_) {
    began_ = now;
    if (now < next_ask_) return;
    next_ask_ = now + wait;
    transport_.send(engage_, {.flag = true});
    return;
  }
  const Vec3 goal = goal_at(now - began_);
  farthest_ = std::max(farthest_, (goal - scene_.registration.point_to_mesh(position_)).norm());
  send_pose(goal_out_, scene_.registration.point_to_robot(goal), now);
}

std::string SimulatedRobot::summary() const {
  char line[200];
  std::snprintf(line, sizeof line,
                "%s; nearest %.3f mm from the mesh (required %.3f); goals up to %.1f mm away",
                setpoints_ == 0 ? "no setpoint" : "moved", nearest_,
                settings_.tool_radius + settings_.margin, farthest_);
  std::string text = line;
  for (const auto& [reason, count] : reasons_) {
    text += "\nreason, " + std::to_string(count) + " times: " + reason;
  }
  return text;
}

}  // namespace keepout::crtk
