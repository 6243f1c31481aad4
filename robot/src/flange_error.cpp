// SPDX-License-Identifier: BSD-3-Clause
#include "flange_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace keepout {
namespace {

constexpr double slack = 0.01;  // of the task

/// Returns a bound of the distance between the ends of the true and the linear motion of the
/// flange, in the units of the task: half of the bound of |p''| (motion_bounds.h), whose levers are
/// columns of the Jacobian; the sum |x| + |y| + |z| bounds their lengths. An axis is off by at most
/// the turns a of all joints, so the turn of the flange is off by at most a^2; the bound is
/// infinite for an a above 1 rad.
double most_deviation(const Chain& chain, const JointTask& task,
                      const JointVector& increment) noexcept {
  MotionBounds bounds;
  double turns = 0.0;
  for (int k = chain.size(); k >= 1; --k) {
    const double moved = std::abs(increment[static_cast<std::size_t>(k - 1)]);
    if (chain.joint(k).kind != JointKind::revolute) {
      bounds.slide(moved);
      continue;
    }
    const Eigen::Map<const Vec3> column(task.jacobian.data() + (k - 1) * task.rows);
    bounds.turn(column.lpNorm<1>(), moved);
    turns += moved;
  }
  if (!(turns <= 1.0)) return std::numeric_limits<double>::infinity();
  return 0.5 * bounds.bend + *task.turn_weight * turns * turns;
}

}  // namespace

FlangeError flange_error(const JointTask& task, const Trial& trial, const Chain& chain,
                         PointMotion& motion) noexcept {
  const double standing = task.standing;
  const double bound = std::sqrt(trial.cost) + most_deviation(chain, task, trial.increment);
  if (bound <= 0.5 * standing) return {bound, false};
  const double predicted = task.linear_miss(trial.increment, trial.fraction);
  const double missed =
      task.true_miss(motion.chain_at_start().flange(), motion.flange_at(trial.fraction));
  // Half of the predicted gain, and little of the task: contacts predict next to no gain.
  const double most = std::max(predicted, 0.5 * (standing + predicted)) + slack * standing;
  return {missed, missed > most};
}

Trial cut_for_flange(const JointTask& task, Trial trial, PointMotion& motion) noexcept {
  constexpr int most_halvings = 12;
  const Pose start = motion.chain_at_start().flange();
  double fraction = trial.fraction;
  trial.limits.add(Limit::linearization);
  trial.fraction = 0.0;
  trial.cost = task.standing * task.standing;
  for (int i = 0; i <= most_halvings; ++i, fraction *= 0.5) {
    const double missed = task.true_miss(start, motion.flange_at(fraction));
    const double cost = missed * missed + task.damping_cost(trial.increment, fraction);
    if (cost < trial.cost) {
      trial.fraction = fraction;
      trial.cost = cost;
    } else if (trial.fraction > 0.0) {
      break;
    }
  }
  return trial;
}

}  // namespace keepout
