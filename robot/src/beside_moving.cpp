// SPDX-License-Identifier: BSD-3-Clause
//
// The search beside meshes that move. To stop is not safe there, so all of a motion is proved or
// nothing; and what cannot be proved for one body must not keep the others from retreating.
#include <algorithm>
#include <bitset>

#include "joint_cycle.h"

namespace keepout {
namespace {

constexpr int most_degradations = 32;  // of a cycle

}  // namespace

/// Searches for less and less of the task, down to a mere retreat. Then stands still, if that is
/// proved. Then drops guides that contradict the clearance, and then lowers the level of pairs by
/// quarters, until a motion is proved for all other pairs. Returns the outcome.
Status JointCycle::search_beside_moving(const JointTask& task, Trial& best) noexcept {
  // Neither bodies that cannot give way nor the task may spend the work that the retreat needs.
  memory_.budget.halved([&] { return settle_immovable(), true; });
  double asked = 1.0;
  const auto search_for = [&](double fraction) {
    asked = fraction;
    search_fraction(task, fraction, best);
    return best.is_proved();
  };
  // Beside a body that touches or is inside, or that is not known, nothing but a retreat is made;
  // bodies that no joint moves apart.
  const bool may_serve_task = pairs_.dropped_for() == Status::free;
  bool found =
      may_serve_task && memory_.budget.halved([&] { return search_for(1.0) || search_for(0.25); });
  found = found || search_for(0.0);
  for (int i = 0; i < most_degradations && !found && degrade(task, best); ++i) {
    found = best.is_proved() || search_for(0.0);
  }
  if (!found) {
    rows_.remember_all();
    return search_status_ != Status::free ? search_status_ : Status::unsolved;
  }
  const bool stands_still =
      std::all_of(best.increment.begin(), best.increment.end(), [](double x) { return x == 0.0; });
  // No body retreats, and a body that could not be certified allows no other motion.
  if (stands_still && !is_ok(pairs_.dropped_for())) return pairs_.dropped_for();
  return pairs_.is_degraded() ? Status::degraded : outcome(best, asked);
}

/// Judges the bodies that no joint moves on the motion of the meshes alone. Lowers or drops the
/// pairs that cannot maintain their clearance. Trials do not judge these pairs again.
void JointCycle::settle_immovable() noexcept {
  bool is_ready = false;
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    if (!pairs_.is_watched(p) || !pairs_.is_immovable(p)) continue;
    if (!is_ready) {
      set_trial({});
      is_ready = true;
    }
    while (pairs_.is_watched(p)) {
      Certificate::Obstacle& obstacle = memory_.obstacles[p];
      const Status status = pairs_.judge(p, rows_.view(), obstacle);
      if (is_ok(status) && obstacle.knot == PointMotion::last_knot) {
        pairs_.settle(p);
      } else {
        give_way(p, 1.0, is_ok(status) ? Status::unsolved : status);
      }
    }
  }
}

/// Stands still if that is proved beside the meshes that move.
bool JointCycle::stand_still(const JointTask& task, Trial& best) noexcept {
  Trial trial;
  trial.fraction = 1.0;
  trial.cost = task.miss_at_rest * task.miss_at_rest;
  judgement_ = judge(trial.increment);
  trial.knot = judgement_.knot;
  if (!trial.is_proved()) return false;
  best = trial;
  return true;
}

/// Gives way where the last attempt failed: guides stop pulling, then the instrument stands still,
/// then a guide is dropped, and last the level of pairs is lowered. (After an infeasible search
/// guides have stopped pulling already.) Returns false if nothing is left to try: also if the
/// solver did not converge before it proposed a motion. If this sets `best`, the instrument stands
/// still, and no search is needed.
bool JointCycle::degrade(const JointTask& task, Trial& best) noexcept {
  // Copied, as stand_still() judges another motion.
  const std::size_t guide = judgement_.guide.guide;
  const bool guide_failed =
      judgement_.guide.knot < PointMotion::last_knot && !guides_.is_dropped(guide);
  std::bitset<most_pairs> failed;
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    failed[p] = pairs_.is_watched(p) && memory_.obstacles[p].knot != PointMotion::last_knot;
  }
  if (search_status_ == Status::ill_posed) return false;
  if (search_status_ != Status::infeasible && guide_failed && problem_.relax_guides(rows_.view()))
    return true;
  if (stand_still(task, best)) return true;
  if (search_status_ == Status::infeasible) return degrade_conflict(task.scaled(0.0));
  if (guide_failed) {
    guides_.drop(guide);
    rows_.remove(owner_of_guide(guide));
    return true;
  }
  prefer_degraded(failed);
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    if (!failed[p]) continue;
    give_way(p, 1.0, search_status_ == Status::free ? Status::unsolved : search_status_);
  }
  return failed.any();
}

/// Removes the pairs at level 1 from a set that has others: few pairs give way, and those entirely,
/// before more do.
void JointCycle::prefer_degraded(std::bitset<most_pairs>& pairs) const noexcept {
  std::bitset<most_pairs> lowered;
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    lowered[p] = pairs[p] && pairs_.is_degraded(p);
  }
  if (lowered.any()) pairs = lowered;
}

/// Degrades a minimal set of pairs and guides whose rows contradict each other: its guides are
/// dropped, or if it has none, the level of its pairs is lowered. Returns true if any changed.
bool JointCycle::degrade_conflict(const JointTask& task) noexcept {
  const OwnerSet conflict = problem_.conflict(task, rows_.view());
  bool changed = false;
  for (std::size_t g = 0; g < guides_.size(); ++g) {
    if (!conflict[owner_of_guide(g)]) continue;
    guides_.drop(g);
    rows_.remove(owner_of_guide(g));
    changed = true;
  }
  if (changed) return true;
  std::bitset<most_pairs> pairs;
  for (std::size_t p = 0; p < pairs_.size(); ++p) pairs[p] = conflict[p];
  prefer_degraded(pairs);
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    if (!pairs[p]) continue;
    give_way(p, reachable_level(p), Status::infeasible);
  }
  return pairs.any();
}

/// Lowers the level of a pair, or drops the pair, as PairWatch::lower_clearance_fraction(). A
/// dropped pair has no obstacle and no rows. `most`: 1 for no bound.
void JointCycle::give_way(std::size_t p, double most, Status reason) noexcept {
  pairs_.lower_clearance_fraction(p, most, reason);
  if (pairs_.is_watched(p)) return;
  memory_.obstacles[p] = {};
  rows_.remove(p);
}

/// Returns the largest level of a pair at which each of its rows, taken alone, can be satisfied
/// within the joint limits: a row demands g . dq >= min(bound, 0) - drift - degradation.
/// Corrections are left out, as they belong to earlier trials. `surplus`: by how much the largest g
/// . dq within the limits exceeds that without a degradation.
double JointCycle::reachable_level(std::size_t p) const noexcept {
  const double full_demand = pairs_.full_demand(p);
  double degradation = 0.0;
  for (const Row& row : rows_.view()) {
    if (row.owner != p) continue;
    double surplus = row.drift - std::min(row.bound, 0.0);
    for (std::size_t k = 0; k < row.gradient.size(); ++k) {
      if (row.gradient[k] == 0.0) continue;
      surplus += std::max(row.gradient[k] * box_.low()[k], row.gradient[k] * box_.high()[k]);
    }
    degradation = std::max(degradation, -surplus);
  }
  return full_demand > 0.0 ? 1.0 - degradation / full_demand : 0.0;
}

}  // namespace keepout
