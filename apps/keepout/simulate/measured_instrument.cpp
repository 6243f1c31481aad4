// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/measured_instrument.h"

#include <algorithm>

#include "keepout/error.h"
#include "operators/strokes.h"

namespace keepout::app {

void MeasuredInstrument::start(InstrumentConstraint guard, std::span<const double> setpoint,
                               double top_speed) {
  simulated_->start(setpoint);
  first_.assign(simulated_->positions().begin(), simulated_->positions().end());
  setpoints_.clear();
  measured_.clear();
  // The base of the chain is placed in the frame of the mesh, so that frame is the robot's.
  constexpr LengthUnit mm = LengthUnit::millimetre;
  const Registration registration =
      Registration::mesh_from_robot(Eigen::Matrix4d::Identity(), {mm, mm, mm});
  CrtkOptions options;
  options.haptic.period = cycle_seconds;
  options.haptic.top_speed = top_speed;
  options.haptic.farthest = 1000.0;  // the operator does not react, and goes anywhere
  session_.emplace(std::move(guard), registration, options);
  session_->on_operating_state(OperatingState::enabled, true);
  session_->on_setpoint_js(setpoint, {.stamp = 0.0});
  if (const CycleStatus status = session_->engage(0.0); !is_ok(status)) {
    throw Error("the session of the simulated robot: " + std::string(reason(status)));
  }
}

HapticCycle MeasuredInstrument::follow(const Pose& goal) {
  const double now = cycle_seconds * static_cast<double>(setpoints_.size());
  session_->on_measured_js(measured_.empty() ? std::span<const double>(first_) : measured_.back(),
                           {.stamp = now});
  session_->on_servo_cp(goal, {.stamp = now});
  session_->tick(now);
  const auto setpoint = session_->setpoint_jp();
  simulated_->follow(setpoint);
  setpoints_.emplace_back(setpoint.begin(), setpoint.end());
  measured_.emplace_back(simulated_->positions().begin(), simulated_->positions().end());
  return session_->cycle();
}

std::vector<double> MeasuredInstrument::errors(std::size_t cycle) const {
  const auto setpoint = monitor::place(robot_, {}, setpoints_[cycle]);
  const auto measured = monitor::place(robot_, {}, measured_[cycle]);
  std::vector<double> errors;
  for (const monitor::JudgedBody& body : robot_.bodies) {
    // The distance is a convex function on the body's core, so it is largest at a corner.
    double largest = 0.0;
    for (const monitor::JudgedPoint& point : body.points) {
      const auto link = static_cast<std::size_t>(point.link);
      largest = std::max(
          largest, (setpoint[link].at(point.position) - measured[link].at(point.position)).norm());
    }
    errors.push_back(largest);
  }
  return errors;
}

}  // namespace keepout::app
