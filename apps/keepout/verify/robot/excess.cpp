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
constexpr int searched_poses = 9;

bool is_within_limits(const Chain& chain, std::span<const double> positions,
                      const RobotTask::Increment& dq, double period) {
  for (int k = 1; k <= chain.size(); ++k) {
    const JointLimits& limits = chain.joint(k).limits;
    const double to = positions[static_cast<std::size_t>(k - 1)] + dq[k - 1];
    if (!(to >= limits.lower && to <= limits.upper) ||
        !(std::abs(dq[k - 1]) <= std::min(limits.increment, limits.velocity * period))) {
      return false;
    }
  }
  return true;
}

}  // namespace

RobotTask::RobotTask(const Chain& chain, std::span<const double> positions, const Twist& desired,
                     const InstrumentOptions& options)
    : jacobian_(6, chain.size()), desired_(6), damping_(chain.size()) {
  const double weight = options.orientation_weight;
  ChainState state;
  chain.place(positions, state);
  for (int k = 1; k <= chain.size(); ++k) {
    jacobian_.col(k - 1) << state.linear(k, chain.size(), state.flange().position),
        weight * state.angular(k, chain.size());
    damping_[k - 1] = options.damping / (state.turns(k) ? 1.0 : weight * weight);
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

double excess(const RobotTask& task, const Chain& chain, std::span<const double> positions,
              std::span<const double> made, const InstrumentOptions& options,
              oracle::InstrumentOracle& oracle, Random& random) {
  const double kept = options.margin - 0.1 * options.band;
  std::vector<double> at(positions.begin(), positions.end());
  std::vector<double> floors(oracle.bodies());
  oracle.move_to(at);
  for (std::size_t b = 0; b < floors.size(); ++b) {
    floors[b] = std::min(kept, oracle.clearance(b, kept));
  }
  const auto is_clear = [&](const RobotTask::Increment& dq) {
    for (int i = searched_poses - 1; i > 0; --i) {  // where it ends is most likely to be too close
      for (std::size_t k = 0; k < at.size(); ++k) {
        at[k] = positions[k] + dq[static_cast<Eigen::Index>(k)] * i / (searched_poses - 1);
      }
      oracle.move_to(at);
      for (std::size_t b = 0; b < floors.size(); ++b) {
        if (oracle.clearance(b, floors[b]) < floors[b]) return false;
      }
    }
    return true;
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
    const bool is_better = task.cost(trial) < least &&
                           is_within_limits(chain, positions, trial, options.period) &&
                           is_clear(trial);
    if (is_better) {
      best = trial;
      least = task.cost(trial);
    }
    size *= is_better ? 2.0 : 0.95;
    if (size < 1e-4) size = 0.5;  // it has settled: once more from afar
  }
  return (cost - least) / task.largest_reduction();
}

}  // namespace keepout::app
