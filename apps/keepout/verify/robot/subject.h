// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "keepout/robot/instrument_constraint.h"
#include "verify/robot/setup.h"

namespace keepout::app {

/// The step of an instrument under test: the step that users get, as a scenario requires it. Tests
/// replace it by sabotaged steps.
class RobotSubject {
 public:
  virtual ~RobotSubject() = default;

  virtual void set_options(const InstrumentOptions& options) = 0;
  virtual void place(std::size_t mesh, const Pose& pose, const Twist& velocity) = 0;
  /// Returns the step. Its views stay valid until the next step.
  virtual InstrumentStep step(std::span<const double> positions, const Twist& desired) = 0;
  /// Returns the work of the last step.
  virtual std::size_t work_units() const { return 0; }
  /// Returns the tolerance that the step guarantees. [length]
  virtual double tolerance() const = 0;
};

std::unique_ptr<RobotSubject> make_subject(const RobotSetup& setup);

}  // namespace keepout::app
