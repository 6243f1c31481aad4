// SPDX-License-Identifier: BSD-3-Clause
//
// The search beside meshes that move. Stopping is not safe there, so a cycle proves a whole motion
// or none. A body without a proof must not keep the others from retreating.
#include <algorithm>
#include <bitset>

#include "joint_cycle.h"

namespace keepout {
namespace {

constexpr int most_degradations = 32;  // of a cycle

}  // namespace

/// Searches for the task, then a quarter of it, then only a retreat. If these fail, calls degrade()
/// and searches for a retreat again, until a motion is proved for all pairs that are not dropped.
/// Returns the outcome.
Status JointCycle::search_beside_moving(const JointTask& task, Trial& best) noexcept {
  // Bodies that no joint moves, and the task, must not spend the work that the retreat needs.
  memory_.budget.halved([&] { return settle_immovable(), true; });
  double asked = 1.0;
  const auto search_for = [&](double fraction) {
    asked = fraction;
    search_fraction(task, fraction, best);
    return best.is_proved();
  };
  // If a pair was dropped whose body a joint moves, only a retreat is allowed.
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
  // This is no retreat, and a dropped pair allows no other motion.
  if (stands_still && !is_ok(pairs_.dropped_for())) return pairs_.dropped_for();
  return pairs_.is_degraded() ? Status::degraded : outcome(best, asked);
}

/// Judges the bodies that no joint moves, for the motion of the meshes alone. Degrades or drops the
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

/// Sets `best` to zero motion if that is proved beside the moving meshes. Returns true if it is
/// proved.
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

/// Relaxes the constraints for which the last attempt failed. In this order: guides stop pulling,
/// the instrument stands still, a guide is dropped, clearance fractions are lowered. (After an
/// infeasible search, guides have stopped pulling already.) Returns false if nothing is left to
/// try, or if the solver did not converge before it proposed a motion. If this sets `best`, the
/// instrument stands still, and no search is needed.
bool JointCycle::degrade(const JointTask& task, Trial& best) noexcept {
  // A copy, because stand_still() judges another motion.
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

/// Removes the pairs with clearance fraction 1 from a set that has others. So few pairs lose all of
/// their clearance before more pairs lose some.
void JointCycle::prefer_degraded(std::bitset<most_pairs>& pairs) const noexcept {
  std::bitset<most_pairs> lowered;
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    lowered[p] = pairs[p] && pairs_.is_degraded(p);
  }
  if (lowered.any()) pairs = lowered;
}

/// Finds a minimal set of pairs and guides whose rows contradict each other. Drops its guides, or
/// if it has no guides, degrades its pairs. Returns true if any changed.
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

/// Lowers the clearance fraction of a pair, or drops the pair: see
/// PairWatch::lower_clearance_fraction(). A dropped pair has no obstacle and no rows.
void JointCycle::give_way(std::size_t p, double most, Status reason) noexcept {
  pairs_.lower_clearance_fraction(p, most, reason);
  if (pairs_.is_watched(p)) return;
  memory_.obstacles[p] = {};
  rows_.remove(p);
}

/// Returns the largest clearance fraction of a pair for which each of its rows alone can be
/// satisfied within the joint limits. A row demands g . dq >= min(bound, 0) - drift - degradation,
/// without corrections, which belong to earlier trials. `surplus`: the largest g . dq within the
/// limits minus the demand without degradation.
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
