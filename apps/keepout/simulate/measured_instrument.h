// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "keepout/oracle/judged_robot.h"
#include "simulate/simulated_robot.h"

namespace keepout::app {

/// Records the setpoints of a stroke, and the positions at which a simulated robot follows them.
class MeasuredInstrument {
 public:
  /// Throws Error like make_simulated_robot. `robot`: for the judge.
  MeasuredInstrument(const std::string& name, oracle::JudgedRobot robot)
      : simulated_(make_simulated_robot(name)), robot_(std::move(robot)) {}

  /// Begins a stroke: the robot is at rest.
  void start(std::span<const double> setpoint);
  /// Simulates a cycle with the servos set to `setpoint`, and records both.
  void follow(std::span<const double> setpoint);

  /// Returns the positions at the start, before the first cycle. [rad or mm]
  std::span<const double> first() const noexcept { return first_; }
  /// Returns the measured positions at the end of a cycle. [rad or mm]
  std::span<const double> positions(std::size_t cycle) const noexcept { return measured_[cycle]; }
  /// Returns the tracking error of each body at the end of a cycle: the largest distance of any of
  /// its points from where the setpoint has that point. [mm]
  std::vector<double> errors(std::size_t cycle) const;

 private:
  std::unique_ptr<SimulatedRobot> simulated_;
  oracle::JudgedRobot robot_;
  std::vector<double> first_;
  std::vector<std::vector<double>> setpoints_, measured_;  // of each cycle
};

}  // namespace keepout::app
