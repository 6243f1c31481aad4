// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "keepout/fixtures/random.h"
#include "keepout/step/motion.h"
#include "setup.h"

namespace keepout::app {

/// The joints of a robot that moves a tip, and their limits.
class TipJoints {
 public:
  TipJoints(const Setup& setup, Random& random);

  /// Adds the Jacobian and the limits to a motion; every 40 cycles of another pose of the robot.
  void attach(Motion& motion);

 private:
  void draw();

  Random* random_;
  bool has_limits_;
  double longest_;  // step of the tip [length]
  std::size_t cycle_ = 0;
  TipJacobian::Matrix jacobian_;
  std::array<double, std::size_t{2} * 7 * 7> rows_{};  // row by row
  std::array<double, std::size_t{2} * 7> bounds_{};
};

}  // namespace keepout::app
