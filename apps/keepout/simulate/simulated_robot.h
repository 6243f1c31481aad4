// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <string>

namespace keepout::app {

/// A robot with masses and with servos whose efforts are limited. Its servos follow setpoints, and
/// its measured positions differ from them. Lengths are in mm, angles in rad.
class SimulatedRobot {
 public:
  virtual ~SimulatedRobot() = default;

  /// Places the joints at `setpoint`, and waits 0.2 s until the servos carry the weights.
  virtual void start(std::span<const double> setpoint) = 0;
  /// Simulates one cycle of 1 ms with the servos set to `setpoint`. Throws std::runtime_error if
  /// the simulation diverges.
  virtual void follow(std::span<const double> setpoint) = 0;

  /// Returns the measured positions of the joints. [rad or mm]
  virtual std::span<const double> positions() const = 0;
  /// Returns the efforts of the servos at the end of the last cycle. [N m or N]
  virtual std::span<const double> efforts() const = 0;
  /// Returns the largest effort of each servo. [N m or N]
  virtual std::span<const double> effort_limits() const = 0;
};

inline constexpr double standard_gravity = 9.81;  // [m/s^2]

/// Returns the model of a robot in MuJoCo (fixtures/robots/psm_dynamics.xml). Gravity points along
/// -z of link 0. `gravity`: the acceleration [m/s^2]. Throws Error if MuJoCo is missing, with the
/// package to install, and for a robot without a model.
std::unique_ptr<SimulatedRobot> make_simulated_robot(const std::string& robot,
                                                     double gravity = standard_gravity);

/// The function that the module mujoco exports under the name `simulated_psm`.
using MakeSimulatedPsm = std::unique_ptr<SimulatedRobot> (*)(double gravity);

}  // namespace keepout::app
