// SPDX-License-Identifier: BSD-3-Clause
//
// The search beside meshes that move. To stop is not safe there, so all of a motion is proved or
// nothing; and what cannot be proved for one body must not keep the others from retreating.
#include <algorithm>
#include <array>
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
  memory_.budget.halved([&] { return settle_immovable(), true; });
  double asked = 1.0;
  const auto is_found = [&](double share) {
    asked = share;
    attempt(task, share, best);
    return best.cell == PointMotion::cells;
  };
  // Beside a body that touches or is inside, or that is not known, nothing but a retreat is made.
  const bool is_whole = watch_.dropped_for() == Status::free;
  bool found = is_whole && memory_.budget.halved([&] { return is_found(1.0) || is_found(0.25); });
  found = found || is_found(0.0);
  for (int i = 0; i < most_degradations && !found && degrade(task, best); ++i) {
    found = best.cell == PointMotion::cells || is_found(0.0);
  }
  result.level = found ? watch_.name_degraded() : 0.0;
  const bool stands_still =
      std::all_of(best.increment.begin(), best.increment.end(), [](double x) { return x == 0.0; });
  if (!found) {
    watch_.name_degraded();
    result.status = trouble_ != Status::free ? trouble_ : Status::unsolved;
    rows_.remember_all();
  } else if (watch_.dropped_for() != Status::free && stands_still) {
    // No body retreats, and a body that could not be certified allows no other motion.
    result.level = 0.0;
    result.status = watch_.dropped_for();
  } else if (!memory_.degraded.empty()) {
    result.status = Status::yielding;
  } else if (asked < 1.0) {
    result.status = Status::fallback;
  } else {
    result.status = best.held.empty() ? Status::free : Status::limited;
  }
}

/// Judges the bodies that no joint moves on the motion of the meshes alone, lowers or drops those
/// that cannot keep their distance, and takes all of them out of what trials are judged for.
void JointCycle::settle_immovable() noexcept {
  bool is_ready = false;
  for (std::size_t p = 0; p < memory_.pairs.size(); ++p) {
    if (!watch_.is_watched(p) || !watch_.is_immovable(p)) continue;
    if (!is_ready) {
      memory_.motion.move({}, options_.certified);
      for (MeshMemory& mesh : memory_.meshes) mesh.motion.move();
      is_ready = true;
    }
    while (watch_.is_watched(p)) {
      const Status looked = judge_pair(p);
      if (is_ok(looked) && memory_.pairs[p].failure.cell == PointMotion::cells) {
        memory_.pairs[p].is_settled = true;
      } else {
        watch_.lower(p, 1.0, is_ok(looked) ? Status::unsolved : looked);
      }
    }
  }
}

/// Stands still if that is proved beside the meshes that move.
bool JointCycle::stand_still(const JointTask& task, Trial& best) noexcept {
  Trial trial{.share = 1.0, .cost = task.standing * task.standing};
  judge(trial);
  if (trial.cell != PointMotion::cells) return false;
  trouble_ = Status::free;
  best = trial;
  return true;
}

/// Gives way where the last attempt failed: guides stop pulling, then the instrument stands still,
/// then a guide is dropped, and last the clearance of pairs is lowered. Returns false if nothing is
/// left to try. If `best` is proved, it stands still.
bool JointCycle::degrade(const JointTask& task, Trial& best) noexcept {
  const Status trouble = trouble_;
  const std::size_t guide = failed_guide_;
  const bool guide_failed = kept_by_guides_ < PointMotion::cells && !guides_.is_dropped(guide);
  std::bitset<most_pairs> failed;
  for (std::size_t p = 0; p < memory_.pairs.size(); ++p) {
    failed[p] = watch_.is_watched(p) && memory_.pairs[p].failure.cell != PointMotion::cells;
  }
  if (trouble == Status::ill_posed) return false;
  if (trouble != Status::infeasible && guide_failed && relax_guides()) return true;
  if (stand_still(task, best)) return true;
  trouble_ = trouble;
  if (trouble == Status::infeasible) return degrade_conflict(task.scaled(0.0));
  if (guide_failed) {
    guides_.drop(guide);
    rows_.remove(most_pairs + guide);
    return true;
  }
  prefer_lowered(failed);
  for (std::size_t p = 0; p < memory_.pairs.size(); ++p) {
    if (!failed[p]) continue;
    watch_.lower(p, 1.0, trouble == Status::free ? Status::unsolved : trouble);
    if (!watch_.is_watched(p)) rows_.remove(p);
  }
  return failed.any();
}

/// Removes the pairs at their full clearance from a set that has others: few pairs give way, and
/// those entirely, before more do.
void JointCycle::prefer_lowered(std::bitset<most_pairs>& pairs) const noexcept {
  std::bitset<most_pairs> lowered;
  for (std::size_t p = 0; p < memory_.pairs.size(); ++p) {
    lowered[p] = pairs[p] && memory_.pairs[p].level < 1.0;
  }
  if (lowered.any()) pairs = lowered;
}

/// Finds a least set of pairs and guides whose rows contradict each other (each is left out in
/// turn, and stays out if the others still do), and gives way in these alone.
bool JointCycle::degrade_conflict(const JointTask& task) noexcept {
  constexpr Softness softest{Relaxation::recovery, 0.0, false, 0.0};
  std::bitset<most_pairs + Guide::most> is_owner;
  for (const ContactRow& row : memory_.rows) is_owner.set(row.owner);
  Solution solution;
  for (std::size_t owner = 0; owner < is_owner.size() && !memory_.budget.is_spent(); ++owner) {
    if (!is_owner[owner]) continue;
    left_out_.set(owner);
    if (pose(task, softest, solution) == SolveStatus::optimal) left_out_.reset(owner);
  }
  const auto is_culprit = [&](std::size_t owner) { return is_owner[owner] && !left_out_[owner]; };
  bool changed = false;
  for (std::size_t g = 0; g < memory_.guides.size(); ++g) {
    if (!is_culprit(most_pairs + g)) continue;
    guides_.drop(g);
    rows_.remove(most_pairs + g);
    changed = true;
  }
  if (!changed) {
    std::bitset<most_pairs> culprits;
    for (std::size_t p = 0; p < memory_.pairs.size(); ++p) culprits[p] = is_culprit(p);
    prefer_lowered(culprits);
    for (std::size_t p = 0; p < memory_.pairs.size(); ++p) {
      if (!culprits[p]) continue;
      watch_.lower(p, reachable_level(p), Status::infeasible);
      if (!watch_.is_watched(p)) rows_.remove(p);
      changed = true;
    }
  }
  left_out_.reset();
  return changed;
}

/// Returns the level of a pair that the joints' limits allow each of its rows by itself.
double JointCycle::reachable_level(std::size_t p) const noexcept {
  const double kept = memory_.pairs[p].kept;
  double missing = 0.0;
  for (const ContactRow& row : memory_.rows) {
    if (row.owner != p) continue;
    double most = row.drift - std::min(row.bound, 0.0);
    for (std::size_t k = 0; k < row.gradient.size(); ++k) {
      if (row.gradient[k] == 0.0) continue;
      most += std::max(row.gradient[k] * box_.low()[k], row.gradient[k] * box_.high()[k]);
    }
    missing = std::max(missing, -most);
  }
  return kept > 0.0 ? 1.0 - missing / kept : 0.0;
}

}  // namespace keepout
