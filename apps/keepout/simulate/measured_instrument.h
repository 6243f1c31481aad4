// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "keepout/control/crtk_session.h"
#include "keepout/monitor/judged_robot.h"
#include "simulate/simulated_robot.h"

namespace keepout::app {

/// An instrument in the loop: a CrtkSession takes the goals of an operator and the measured joints,
/// and its setpoints drive a simulated robot. Records setpoints and measured joints of a stroke.
class MeasuredInstrument {
 public:
  /// Throws Error like make_simulated_robot. `robot`: for the judge.
  MeasuredInstrument(const std::string& name, monitor::JudgedRobot robot)
      : simulated_(make_simulated_robot(name)), robot_(std::move(robot)) {}

  /// Begins a stroke: the robot is at rest, and the session is engaged. `guard`: with a mesh.
  /// `top_speed`: of the setpoint [mm/s].
  void start(InstrumentConstraint guard, std::span<const double> setpoint, double top_speed);
  /// Runs one cycle of the session towards a goal of the operator, then one of the robot.
  HapticCycle follow(const Pose& goal);

  /// Returns the positions at the start, before the first cycle. [rad or mm]
  std::span<const double> first() const noexcept { return first_; }
  /// Returns the setpoint of the last cycle. [rad or mm]
  std::span<const double> setpoint() const noexcept { return setpoints_.back(); }
  /// Returns the measured positions at the end of a cycle. [rad or mm]
  std::span<const double> positions(std::size_t cycle) const noexcept { return measured_[cycle]; }
  /// Returns the tracking error of each body at the end of a cycle: the largest distance of any of
  /// its points from where the setpoint has that point. [mm]
  std::vector<double> errors(std::size_t cycle) const;

 private:
  std::unique_ptr<SimulatedRobot> simulated_;
  monitor::JudgedRobot robot_;
  std::optional<CrtkSession> session_;
  std::vector<double> first_;
  std::vector<std::vector<double>> setpoints_, measured_;  // of each cycle
};

}  // namespace keepout::app
