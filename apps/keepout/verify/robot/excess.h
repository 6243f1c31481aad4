// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "keepout/fixtures/random.h"
#include "keepout/judges/robot_judge.h"
#include "keepout/robot/instrument_constraint.h"

namespace keepout::app {

/// What a step is asked to make small, computed once more: |J dq - v|_W^2 + damping |dq|^2, where a
/// turn of the flange, and what a prismatic joint moves by, count in orientation weights.
class RobotTask {
 public:
  using Increment = Eigen::VectorXd;  // of the joints

  RobotTask(const Chain& chain, std::span<const double> positions, const Twist& desired,
            const InstrumentOptions& options);

  double cost(const Increment& dq) const {
    return (jacobian_ * dq - desired_).squaredNorm() + damping_.dot(dq.cwiseAbs2());
  }
  /// How much of the motion that is asked for is made: what goes along it.
  double share(const Increment& dq) const {
    return desired_.dot(jacobian_ * dq) / desired_.squaredNorm();
  }
  /// How much less the cost becomes where nothing holds the joints back.
  double largest_reduction() const;
  /// For each joint, the increment that alone moves the flange as far as is asked for.
  Increment scales() const;

 private:
  Eigen::MatrixXd jacobian_;  // weighed (6, n)
  Eigen::VectorXd desired_;   // weighed (6)
  Eigen::VectorXd damping_;   // of each joint (n)
};

/// The result of a search for a better motion than the step made.
struct Search {
  double saved;  // of its cost, as a share of the largest reduction
  double share;  // of the motion asked for that the best motion found makes
};

/// Searches for a better motion than the one that was made, locally and at random, among joint
/// increments that the judge would allow in the coming cycle.
Search search(const RobotTask& task, std::span<const double> positions,
              std::span<const double> made, oracle::RobotJudge& judge, Random& random);

}  // namespace keepout::app
