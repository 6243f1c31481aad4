// SPDX-License-Identifier: BSD-3-Clause
#include "verify/robot/excess.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

namespace keepout::app {
namespace {

constexpr int search_trials = 800;

}  // namespace

RobotTask::RobotTask(const Chain& chain, std::span<const double> positions, const Twist& desired,
                     const InstrumentOptions& options)
    : jacobian_(6, chain.size()), desired_(6), damping_(chain.size()) {
  const double weight = options.orientation_weight;
  // Reference of the damping of prismatic joints.
  const double of_slides = weight > 0.0 ? weight : 1.0;
  ChainState state;
  chain.forward_kinematics(positions, state);
  for (int k = 1; k <= chain.size(); ++k) {
    jacobian_.col(k - 1) << state.linear(k, chain.size(), state.flange().position),
        weight * state.angular(k, chain.size());
    damping_[k - 1] = options.damping / (state.turns(k) ? 1.0 : of_slides * of_slides);
  }
  desired_ << desired.linear, weight * desired.angular;
}

double RobotTask::largest_reduction() const {
  Eigen::MatrixXd hessian = jacobian_.transpose() * jacobian_;
  hessian.diagonal() += damping_;
  const Eigen::VectorXd gradient = jacobian_.transpose() * desired_;
  return gradient.dot(hessian.ldlt().solve(gradient));
}

RobotTask::Increment RobotTask::scales() const {
  const Eigen::ArrayXd lengths = jacobian_.colwise().norm().transpose().array();
  return desired_.norm() / lengths.max(1e-3 * lengths.maxCoeff());
}

Search search(const RobotTask& task, std::span<const double> positions,
              std::span<const double> made, oracle::RobotJudge& judge, Random& random) {
  std::vector<double> next(positions.size());
  const auto is_allowed = [&](const RobotTask::Increment& dq) {
    for (std::size_t k = 0; k < next.size(); ++k) {
      next[k] = positions[k] + dq[static_cast<Eigen::Index>(k)];
    }
    return judge.would_allow(next);
  };
  RobotTask::Increment best =
      Eigen::Map<const Eigen::VectorXd>(made.data(), static_cast<Eigen::Index>(made.size()));
  const double cost = task.cost(best);
  const RobotTask::Increment scales = task.scales();
  double least = cost;
  double size = 0.5;
  for (int i = 0; i < search_trials; ++i) {
    RobotTask::Increment trial = best;
    for (Eigen::Index k = 0; k < trial.size(); ++k) {
      trial[k] += size * random.uniform(-1.0, 1.0) * scales[k];
    }
    const bool is_better = task.cost(trial) < least && is_allowed(trial);
    if (is_better) {
      best = trial;
      least = task.cost(trial);
    }
    size *= is_better ? 2.0 : 0.95;
    if (size < 1e-4) size = 0.5;  // it has converged: search again from farther away
  }
  return {(cost - least) / task.largest_reduction(), task.share(best)};
}

}  // namespace keepout::app
