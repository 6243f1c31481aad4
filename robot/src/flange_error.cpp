// SPDX-License-Identifier: BSD-3-Clause
#include "flange_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace keepout {
namespace {

constexpr double slack = 0.01;  // a fraction of the miss of zero motion

/// Returns a bound of the distance between the ends of the true and the linear motion of the
/// flange, in the units of the task: M/2 + orientation_weight a^2. M bounds |p''|
/// (motion_bounds.h). Its levers are the columns of the Jacobian, whose lengths are at most |x| +
/// |y| + |z|. a is the sum of the turns of all joints. An axis is off by at most a, so the turn of
/// the flange is off by at most a^2. Infinite if a is above 1 rad.
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
    const Eigen::Map<const Vec3> column(task.jacobian.data() + (k - 1) * task.equations);
    bounds.turn(column.lpNorm<1>(), moved);
    turns += moved;
  }
  if (!(turns <= 1.0)) return std::numeric_limits<double>::infinity();
  return 0.5 * bounds.bend + *task.orientation_weight * turns * turns;
}

}  // namespace

FlangeError flange_error(const JointTask& task, const Trial& trial, const Chain& chain,
                         PointMotion& motion) noexcept {
  const double miss_at_rest = task.miss_at_rest;
  const double bound = std::sqrt(trial.cost) + most_deviation(chain, task, trial.increment);
  if (bound <= 0.5 * miss_at_rest) return {bound, false};
  const double predicted = task.linear_miss(trial.increment, trial.fraction);
  const double missed =
      task.true_miss(motion.chain_at_start().flange(), motion.flange_at(trial.fraction));
  // The miss may be the predicted one, or larger by half of the predicted gain. It may be larger by
  // another 1 % of the task, because the predicted gain is about 0 in contact.
  const double most = std::max(predicted, 0.5 * (miss_at_rest + predicted)) + slack * miss_at_rest;
  return {missed, missed > most};
}

Trial cut_for_flange(const JointTask& task, Trial trial, PointMotion& motion) noexcept {
  constexpr int most_halvings = 12;
  const Pose start = motion.chain_at_start().flange();
  double fraction = trial.fraction;
  trial.limits.add(Limit::linearization);
  trial.fraction = 0.0;
  trial.cost = task.miss_at_rest * task.miss_at_rest;
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
