// SPDX-License-Identifier: BSD-3-Clause
//
// The true motion of the flange against the linear task. The certificate proves a motion clear; it
// does not say that the motion is the one that was asked for.
#include <algorithm>

#include "joint_cycle.h"

namespace keepout {
namespace {

constexpr double slack = 0.01;  // of what is desired

}  // namespace

/// Measures what the true motion of the flange misses (Trial::missed). Returns true if it makes
/// less than half of what the linear task promises, or ends farther from what is desired than it
/// stands. Recoveries and joint tasks never stray.
bool JointCycle::strays(const JointTask& task, Trial& trial) noexcept {
  const bool is_judged = task.turn_weight.has_value() && !is_recovering() &&
                         options_.certified == CertifiedMotion::actual;
  if (!is_judged) return false;
  const double standing = task.standing_miss();
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
  const double standing = task.standing_miss();
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
