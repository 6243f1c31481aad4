// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "keepout/index/query.h"
#include "node.h"
#include "settings.h"

namespace keepout::crtk {

/// A robot that is always where it was sent, and its operator, to try a guard of a tip. Again and
/// again, the operator pushes the tip into the highest place of the mesh, sideways, and back.
class SimulatedRobot final : public Node {
 public:
  /// Subscribes and announces. `transport` must outlive the node.
  SimulatedRobot(const Settings& settings, const Scene& scene, Transport& transport);

  void receive(int topic, const Message& message) override;
  void cycle(double now) override;
  std::string summary() const override;

 private:
  Vec3 goal_at(double seconds) const;
  void send_pose(int topic, const Vec3& point, double now);

  Settings settings_;
  Scene scene_;
  Transport& transport_;
  NearestTriangle nearest_triangle_;
  int servo_cp_, state_in_, reason_in_;
  int measured_cp_, setpoint_cp_, state_out_, goal_out_, engage_;
  Vec3 start_;     // in the frame of the mesh [mm]
  Vec3 position_;  // of the robot [m]
  bool is_engaged_ = false;
  double began_ = 0.0;  // when the operator began [s]
  double next_ask_ = 0.0;
  std::uint64_t setpoints_ = 0;
  double nearest_ = 1e9;   // of all setpoints to the mesh [mm]
  double farthest_ = 0.0;  // from a goal to its setpoint [mm]
  std::map<std::string, int> reasons_;
};

}  // namespace keepout::crtk
