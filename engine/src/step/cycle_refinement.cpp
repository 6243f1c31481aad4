// SPDX-License-Identifier: BSD-3-Clause
//
// Better motions than the first that is accepted: planes linearized again there, and branch and
// bound.
#include "cycle.h"

namespace keepout {
namespace {

using Verdict = Judgement::Verdict;

}  // namespace

/// Linearizes the planes of an accepted motion again, at that motion, while they allow a better
/// one, at most options.refinements times. All planes go on allowing the accepted motion, so
/// nothing is lost.
Cycle::Trial Cycle::refine(Trial best) noexcept {
  const Vec3 accepted = problem_.accepted;
  for (int refinement = 0; refinement < options_.refinements; ++refinement) {
    work_.save();
    problem_.accepted = best.motion;
    if (rule_.relinearize(problem_, work_.earlier_planes.view(), work_.planes)) {
      const Trial next = search();
      const bool is_accepted = next.status == Status::limited || next.status == Status::free;
      if (is_accepted && is_worthwhile(next.motion, best.motion)) {
        best = next;
        continue;
      }
    }
    work_.restore();
    break;
  }
  problem_.accepted = accepted;
  return best;
}

/// Searches for a better motion than the best one known, by branch and bound. For each triangle
/// there are alternative planes; a node is a choice of one plane for each triangle met so far, and
/// no motion within its planes is better than the nearest one. The node of least cost goes first:
/// once the rule accepts its motion, no other choice of the planes considered has a better one.
///
/// At most options.nodes nodes. The rule judges every motion that is returned, so the limit costs
/// quality and never safety.
Cycle::Trial Cycle::branch(const Trial& best) noexcept {
  work_.save();
  work_.branches.clear();
  push_branch(best);
  for (int node = 0; node < options_.nodes && !budget_.is_spent(); ++node) {
    const Branch* nearest = work_.branches.pop_nearest();
    if (nearest == nullptr) break;
    work_.planes.assign(nearest->planes());
    const Verdict verdict = rule_.judge(problem_, nearest->motion, work_.planes).verdict;
    if (verdict == Verdict::accepted) {
      // Solved once more: the solver's memory holds a later solution.
      const Trial trial = solve();
      if (!is_ok(trial.status) || trial.motion != nearest->motion) break;
      work_.store_result(request_, trial.motion, 1.0, relaxation_, {});
      return {Status::limited, trial.motion};
    }
    if (verdict == Verdict::blocked) continue;
    // The plane that the rule has added is one choice; there may be alternatives. (The last plane
    // may be that of a wall, in a recovery: then the choice is among planes of the wall.)
    const TriangleId in_the_way = work_.planes[work_.planes.size() - 1].source;
    push_branch(best);
    work_.alternatives.clear();
    rule_.add_alternatives(in_the_way, work_.alternatives);
    for (const HalfSpace& alternative : work_.alternatives) {
      work_.planes.assign(nearest->planes());
      work_.planes.push(alternative);
      push_branch(best);
    }
  }
  work_.restore();
  return best;
}

/// Adds a node for the present planes, unless it cannot contain a better motion.
void Cycle::push_branch(const Trial& best) noexcept {
  const Trial trial = solve();
  if (!is_ok(trial.status) || trial.motion.norm() > problem_.longest) return;
  if (!work_.guides.allow(trial.motion)) return;
  if (!is_worthwhile(trial.motion, best.motion)) return;
  work_.branches.push((problem_.target - trial.motion).norm(), trial.motion, work_.planes.view());
}

/// Returns true if a motion is nearer to the target than the best one, by more than a millionth of
/// the target.
bool Cycle::is_worthwhile(const Vec3& motion, const Vec3& best) const noexcept {
  const Vec3& target = problem_.target;
  return (target - motion).norm() < (target - best).norm() - 1e-6 * target.norm();
}

}  // namespace keepout
