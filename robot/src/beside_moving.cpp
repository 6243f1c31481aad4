// SPDX-License-Identifier: BSD-3-Clause
//
// The search beside meshes that move. To stop is not safe there, so all of a motion is proved or
// nothing; and what cannot be proved for one body must not keep the others from retreating.
#include <algorithm>
#include <array>

#include "joint_cycle.h"

namespace keepout {
namespace {

constexpr int most_degradations = 32;  // of a cycle

}  // namespace

/// Asks for less and less of the task, down to retreating only. Then guides that contradict the
/// clearance are dropped, then pairs of body and mesh that cannot be kept are lowered, by quarters,
/// until a motion is proved for all the others.
void JointCycle::search_beside_moving(const JointTask& task, Trial& best,
                                      InstrumentStep& result) noexcept {
  settle_immovable();
  double asked = 1.0;
  const auto is_found = [&](double share) {
    asked = share;
    attempt(task, share, best);
    return best.cell == PointMotion::cells;
  };
  // Beside a body that touches or is inside, or that is not known, nothing but a retreat is made.
  const bool is_whole = watch_.dropped_for() == Status::free;
  bool found = (is_whole && (is_found(1.0) || is_found(0.25))) || is_found(0.0);
  for (int i = 0; i < most_degradations && !found && degrade(task); ++i) found = is_found(0.0);
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

/// Gives way in what the last attempt failed by: guides first. Returns false if nothing is left.
bool JointCycle::degrade(const JointTask& task) noexcept {
  if (trouble_ == Status::infeasible) return degrade_conflict(task.scaled(0.0));
  if (kept_by_guides_ < PointMotion::cells && !guides_.is_dropped(failed_guide_)) {
    guides_.drop(failed_guide_);
    rows_.remove(most_pairs + failed_guide_);
    return true;
  }
  bool changed = false;
  for (std::size_t p = 0; p < memory_.pairs.size(); ++p) {
    if (!watch_.is_watched(p) || memory_.pairs[p].failure.cell == PointMotion::cells) continue;
    watch_.lower(p, 1.0, trouble_ == Status::free ? Status::unsolved : trouble_);
    if (!watch_.is_watched(p)) rows_.remove(p);
    changed = true;
  }
  return changed;
}

/// Finds a least set of pairs and guides whose rows contradict each other (each is left out in
/// turn, and stays out if the others still do), and gives way in these alone.
bool JointCycle::degrade_conflict(const JointTask& task) noexcept {
  constexpr Softness softest{Relaxation::recovery, 0.0, false, 0.0};
  std::array<bool, most_pairs + Guide::most> is_owner{};
  for (const ContactRow& row : memory_.rows) is_owner[row.owner] = true;
  Solution solution;
  for (std::size_t owner = 0; owner < is_owner.size() && !memory_.budget.is_spent(); ++owner) {
    if (!is_owner[owner]) continue;
    is_left_out_[owner] = true;
    if (pose(task, softest, solution) == SolveStatus::optimal) is_left_out_[owner] = false;
  }
  const auto is_culprit = [&](std::size_t owner) {
    return is_owner[owner] && !is_left_out_[owner];
  };
  bool changed = false;
  for (std::size_t g = 0; g < memory_.guides.size(); ++g) {
    if (!is_culprit(most_pairs + g)) continue;
    guides_.drop(g);
    rows_.remove(most_pairs + g);
    changed = true;
  }
  for (std::size_t p = 0; p < memory_.pairs.size() && !changed; ++p) {
    if (!is_culprit(p)) continue;
    for (std::size_t other = p; other < memory_.pairs.size(); ++other) {
      if (!is_culprit(other)) continue;
      watch_.lower(other, reachable_level(other), Status::infeasible);
      if (!watch_.is_watched(other)) rows_.remove(other);
    }
    changed = true;
  }
  is_left_out_.fill(false);
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
