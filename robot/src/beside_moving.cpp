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
/// proved. Then drops guides that contradict the clearance, and then lowers the clearance of pairs
/// of body and mesh by quarters, until a motion is proved for all other pairs.
void JointCycle::search_beside_moving(const JointTask& task, Trial& best,
                                      InstrumentStep& result) noexcept {
  // Neither bodies that cannot give way nor the task may spend the work that the retreat needs.
  context_.budget.halved([&] { return settle_immovable(), true; });
  double asked = 1.0;
  const auto is_found = [&](double share) {
    asked = share;
    search_fraction(task, share, best);
    return best.is_proved();
  };
  // Beside a body that touches or is inside, or that is not known, nothing but a retreat is made.
  const bool are_all_certified = bodies_.dropped_for() == Status::free;
  bool found =
      are_all_certified && context_.budget.halved([&] { return is_found(1.0) || is_found(0.25); });
  found = found || is_found(0.0);
  for (int i = 0; i < most_degradations && !found && degrade(task, best); ++i) {
    found = best.is_proved() || is_found(0.0);
  }
  const double least_fraction = bodies_.list_degraded();
  result.level = found ? least_fraction : 0.0;
  const bool stands_still =
      std::all_of(best.increment.begin(), best.increment.end(), [](double x) { return x == 0.0; });
  if (!found) {
    result.status = search_status_ != Status::free ? search_status_ : Status::unsolved;
    rows_.remember_all();
  } else if (bodies_.dropped_for() != Status::free && stands_still) {
    // No body retreats, and a body that could not be certified allows no other motion.
    result.level = 0.0;
    result.status = bodies_.dropped_for();
  } else if (!bodies_.degraded().empty()) {
    result.status = Status::yielding;
  } else if (asked < 1.0) {
    result.status = Status::fallback;
  } else {
    result.status = best.limits.empty() ? Status::free : Status::limited;
  }
}

/// Judges the bodies that no joint moves on the motion of the meshes alone. Lowers or drops those
/// that cannot maintain their clearance. Trials do not judge these bodies again.
void JointCycle::settle_immovable() noexcept {
  bool is_ready = false;
  for (std::size_t p = 0; p < bodies_.size(); ++p) {
    if (!bodies_.is_watched(p) || !bodies_.is_immovable(p)) continue;
    if (!is_ready) {
      try_motion({});
      is_ready = true;
    }
    while (bodies_.is_watched(p)) {
      Certificate::Obstacle& obstacle = memory_.obstacles[p];
      const Status status = bodies_.judge(p, rows_.view(), obstacle);
      if (is_ok(status) && obstacle.knot == PointMotion::last_knot) {
        bodies_.settle(p);
      } else {
        lower(p, 1.0, is_ok(status) ? Status::unsolved : status);
      }
    }
  }
}

/// Stands still if that is proved beside the meshes that move.
bool JointCycle::stand_still(const JointTask& task, Trial& best) noexcept {
  Trial trial{.fraction = 1.0, .cost = task.standing * task.standing};
  judge(trial);
  if (!trial.is_proved()) return false;
  search_status_ = Status::free;
  best = trial;
  return true;
}

/// Gives way where the last attempt failed: guides stop pulling, then the instrument stands still,
/// then a guide is dropped, and last the clearance of pairs is lowered. Returns false if nothing is
/// left to try. If `best` is proved, it stands still.
bool JointCycle::degrade(const JointTask& task, Trial& best) noexcept {
  const Status trouble = search_status_;
  const std::size_t guide = guide_obstacle_.guide;
  const bool guide_failed =
      guide_obstacle_.knot < PointMotion::last_knot && !guides_.is_dropped(guide);
  std::bitset<most_pairs> failed;
  for (std::size_t p = 0; p < bodies_.size(); ++p) {
    failed[p] = bodies_.is_watched(p) && memory_.obstacles[p].knot != PointMotion::last_knot;
  }
  if (trouble == Status::ill_posed) return false;
  if (trouble != Status::infeasible && guide_failed && problem_.relax_guides(rows_.view()))
    return true;
  if (stand_still(task, best)) return true;
  search_status_ = trouble;
  if (trouble == Status::infeasible) return degrade_conflict(task.scaled(0.0));
  if (guide_failed) {
    guides_.drop(guide);
    rows_.remove(owner_of_guide(guide));
    return true;
  }
  prefer_degraded(failed);
  for (std::size_t p = 0; p < bodies_.size(); ++p) {
    if (!failed[p]) continue;
    lower(p, 1.0, trouble == Status::free ? Status::unsolved : trouble);
    if (!bodies_.is_watched(p)) rows_.remove(p);
  }
  return failed.any();
}

/// Removes the pairs at their full clearance from a set that has others: few pairs give way, and
/// those entirely, before more do.
void JointCycle::prefer_degraded(std::bitset<most_pairs>& pairs) const noexcept {
  std::bitset<most_pairs> lowered;
  for (std::size_t p = 0; p < bodies_.size(); ++p) {
    lowered[p] = pairs[p] && bodies_.is_degraded(p);
  }
  if (lowered.any()) pairs = lowered;
}

/// Degrades a minimal set of pairs and guides whose rows contradict each other: its guides are
/// dropped, or if it has none, the clearance of its pairs is lowered. Returns true if any changed.
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
  for (std::size_t p = 0; p < bodies_.size(); ++p) pairs[p] = conflict[p];
  prefer_degraded(pairs);
  for (std::size_t p = 0; p < bodies_.size(); ++p) {
    if (!pairs[p]) continue;
    lower(p, reachable_fraction(p), Status::infeasible);
    if (!bodies_.is_watched(p)) rows_.remove(p);
  }
  return pairs.any();
}

/// Lowers the clearance of a pair, or drops the pair. A dropped pair has no obstacle.
void JointCycle::lower(std::size_t p, double most, Status reason) noexcept {
  bodies_.lower(p, most, reason);
  if (!bodies_.is_watched(p)) memory_.obstacles[p] = {};
}

/// Returns the largest clearance fraction of a pair at which each of its rows, taken alone, can be
/// satisfied within the joint limits.
double JointCycle::reachable_fraction(std::size_t p) const noexcept {
  const double clearance = bodies_.full_clearance(p);
  double missing = 0.0;
  for (const Row& row : rows_.view()) {
    if (row.owner != p) continue;
    double most = row.drift - std::min(row.bound, 0.0);
    for (std::size_t k = 0; k < row.gradient.size(); ++k) {
      if (row.gradient[k] == 0.0) continue;
      most += std::max(row.gradient[k] * box_.low()[k], row.gradient[k] * box_.high()[k]);
    }
    missing = std::max(missing, -most);
  }
  return clearance > 0.0 ? 1.0 - missing / clearance : 0.0;
}

}  // namespace keepout
