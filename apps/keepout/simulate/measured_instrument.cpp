// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/measured_instrument.h"

#include <algorithm>

namespace keepout::app {

void MeasuredInstrument::start(std::span<const double> setpoint) {
  simulated_->start(setpoint);
  first_.assign(simulated_->positions().begin(), simulated_->positions().end());
  setpoints_.clear();
  measured_.clear();
}

void MeasuredInstrument::follow(std::span<const double> setpoint) {
  simulated_->follow(setpoint);
  setpoints_.emplace_back(setpoint.begin(), setpoint.end());
  measured_.emplace_back(simulated_->positions().begin(), simulated_->positions().end());
}

std::vector<double> MeasuredInstrument::errors(std::size_t cycle) const {
  const auto setpoint = oracle::place(robot_, {}, setpoints_[cycle]);
  const auto measured = oracle::place(robot_, {}, measured_[cycle]);
  std::vector<double> errors;
  for (const oracle::JudgedBody& body : robot_.bodies) {
    // The distance is a convex function on the body's core, so it is largest at a corner.
    double largest = 0.0;
    for (const oracle::JudgedPoint& point : body.points) {
      const auto link = static_cast<std::size_t>(point.link);
      largest = std::max(
          largest, (setpoint[link].at(point.position) - measured[link].at(point.position)).norm());
    }
    errors.push_back(largest);
  }
  return errors;
}

}  // namespace keepout::app
