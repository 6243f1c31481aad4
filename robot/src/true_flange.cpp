// SPDX-License-Identifier: BSD-3-Clause
//
// The true motion of the flange against the linear task. The certificate proves a motion clear; it
// does not say that the motion is the one that was asked for.
#include <algorithm>
#include <cmath>
#include <limits>

#include "joint_cycle.h"

namespace keepout {
namespace {

constexpr double slack = 0.01;  // of what is desired

/// Returns a bound of how far the true motion of the flange ends from the linear one, in the units
/// of the task: half of the bound of |p''| (motion_bounds.h), whose levers are columns of the
/// Jacobian; the sum |x| + |y| + |z| bounds their lengths. An axis is off by at most the turns a of
/// all joints, so the turn of the flange is off by at most a^2; the bound is infinite for an a
/// above 1 rad.
double most_deviation(const Chain& chain, const JointTask& task,
                      const JointVector& increment) noexcept {
  MotionBounds bounds;
  double turns = 0.0;
  for (int k = chain.size(); k >= 1; --k) {
    const double moved = std::abs(increment[static_cast<std::size_t>(k - 1)]);
    if (chain.joint(k).kind != JointKind::revolute) {
      bounds.path += moved;
      continue;
    }
    const Eigen::Map<const Vec3> column(task.jacobian.data() + (k - 1) * task.rows);
    const double way = (column.lpNorm<1>() + bounds.path) * moved;
    bounds.bend += moved * (way + 2.0 * bounds.path);
    bounds.path += way;
    turns += moved;
  }
  if (!(turns <= 1.0)) return std::numeric_limits<double>::infinity();
  return 0.5 * bounds.bend + *task.turn_weight * turns * turns;
}

}  // namespace

/// Measures what the true motion of the flange misses (Trial::missed), or bounds it if the motion
/// is certain to make half of what is desired. Returns true if the motion makes less than half of
/// what the linear task promises, or ends farther from what is desired than it stands. Recoveries
/// and joint tasks never stray.
bool JointCycle::strays(const JointTask& task, Trial& trial) noexcept {
  const bool is_judged = task.turn_weight.has_value() && !is_recovering() &&
                         options_.certified == CertifiedMotion::actual;
  if (!is_judged) return false;
  const double standing = task.standing;
  trial.missed =
      std::sqrt(trial.cost) + most_deviation(memory_.instrument.chain(), task, trial.increment);
  if (trial.missed <= 0.5 * standing) return false;
  const double predicted = task.linear_miss(trial.increment, trial.share);
  trial.missed = task.true_miss(memory_.motion.chain_at_start().flange(),
                                memory_.motion.flange_at(trial.share));
  // Half of the gain that is promised, and little of what is asked: contacts promise next to
  // nothing.
  return trial.missed > std::max(predicted, 0.5 * (standing + predicted)) + slack * standing;
}

/// Cuts a motion to the fraction, of halves, that costs least for the true flange; to nothing where
/// all of them cost more than standing still.
void JointCycle::cut_to_best(const JointTask& task, Trial& trial) noexcept {
  constexpr int most_halvings = 12;
  const Pose start = memory_.motion.chain_at_start().flange();
  const double standing = task.standing;
  const double whole = trial.share;
  trial.held.add(Limit::linearization);
  trial.share = 0.0;
  trial.cost = standing * standing;
  double share = whole;
  for (int i = 0; i <= most_halvings; ++i, share *= 0.5) {
    const double missed = task.true_miss(start, memory_.motion.flange_at(share));
    const double cost = missed * missed + task.damping_cost(trial.increment, share);
    if (cost < trial.cost) {
      trial.share = share;
      trial.cost = cost;
    } else if (trial.share > 0.0) {
      return;
    }
  }
}

}  // namespace keepout
