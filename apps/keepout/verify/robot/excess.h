// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "keepout/fixtures/random.h"
#include "keepout/judges/robot_judge.h"
#include "keepout/robot/instrument_constraint.h"

namespace keepout::app {

/// The cost that a step minimizes, computed independently: |J dq - v|_W^2 + damping |dq|^2.
/// Rotations of the flange and displacements of prismatic joints are scaled by the orientation
/// weight.
class RobotTask {
 public:
  using Increment = Eigen::VectorXd;  // of the joints

  RobotTask(const Chain& chain, std::span<const double> positions, const Twist& desired,
            const InstrumentOptions& options);

  double cost(const Increment& dq) const {
    return (jacobian_ * dq - desired_).squaredNorm() + damping_.dot(dq.cwiseAbs2());
  }
  /// Returns the fraction of the commanded motion that an increment executes, along that motion.
  double share(const Increment& dq) const {
    return desired_.dot(jacobian_ * dq) / desired_.squaredNorm();
  }
  /// Returns the reduction of the cost by the unconstrained optimum.
  double largest_reduction() const;
  /// Returns for each joint the increment that alone moves the flange as far as commanded.
  Increment scales() const;

 private:
  Eigen::MatrixXd jacobian_;  // weighted (6, n)
  Eigen::VectorXd desired_;   // weighted (6)
  Eigen::VectorXd damping_;   // of each joint (n)
};

/// The result of a search for a better motion than that of the step.
struct Search {
  double saved;  // reduction of its cost, as a fraction of the largest reduction
  double share;  // fraction of the commanded motion that the best motion executes
};

/// Searches at random for a better motion than `made`, among joint increments that the judge would
/// allow in the next cycle.
Search search(const RobotTask& task, std::span<const double> positions,
              std::span<const double> made, oracle::RobotJudge& judge, Random& random);

}  // namespace keepout::app
