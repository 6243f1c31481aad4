// SPDX-License-Identifier: BSD-3-Clause
//
// Better motions than the first that is accepted: planes linearized again there, and branch and
// bound.
#include "cycle.h"

namespace keepout {

/// Linearizes the planes of an accepted motion again, at that motion (the certified rule turns
/// them: the rotation of the cuts of docs/certified-step-algorithm.md), while they allow a better
/// one, at most options.refinements times. All planes go on allowing the accepted motion, so
/// nothing is lost.
Cycle::Outcome Cycle::refine(Outcome best) noexcept {
  for (int refinement = 0; refinement < options_.refinements; ++refinement) {
    memory_.set_aside();
    input_.accepted = best.motion;
    if (rule_.relinearize(input_, memory_.earlier_planes.view(), memory_.planes)) {
      const Outcome next = search();
      const bool is_whole = next.status == Status::limited || next.status == Status::free;
      if (is_whole && is_worthwhile(next.motion, best.motion)) {
        best = next;
        continue;
      }
    }
    memory_.take_back();
    break;
  }
  input_.accepted.setZero();
  return best;
}

/// Searches for a better motion than the best one known, by branch and bound. For each triangle
/// there are alternative planes; a node is a choice of one plane for each triangle met so far, and
/// no motion within its planes is better than the nearest one. The node of least cost goes first:
/// once the rule accepts its motion, no other choice of the planes considered has a better one.
///
/// At most options.nodes nodes. The rule judges every motion that is returned, so the limit costs
/// quality and never safety.
Cycle::Outcome Cycle::branch(const Outcome& best) noexcept {
  memory_.set_aside();
  memory_.branches.clear();
  push_branch(best);
  for (int node = 0; node < options_.nodes && !budget_.is_spent(); ++node) {
    const Branch* nearest = memory_.branches.pop_nearest();
    if (nearest == nullptr) break;
    memory_.planes.assign(nearest->planes());
    const Verdict verdict = rule_.judge(input_, nearest->motion, memory_.planes).verdict;
    if (verdict == Verdict::accepted) {
      // Solved once more: the solver's memory holds a later solution.
      const Trial trial = solve();
      if (trial.motion != nearest->motion) break;
      memory_.store_result(request_, nearest->motion, 1.0, trial.solution, relaxation_, {});
      return {Status::limited, nearest->motion};
    }
    if (verdict == Verdict::blocked) continue;
    // The plane that the rule has added is one choice; there may be alternatives. (The last plane
    // may be that of a wall, in a recovery: then the choice is among planes of the wall.)
    const TriangleId in_the_way = memory_.planes[memory_.planes.size() - 1].source;
    push_branch(best);
    memory_.alternatives.clear();
    rule_.add_alternatives(in_the_way, memory_.alternatives);
    for (const HalfSpace& alternative : memory_.alternatives) {
      memory_.planes.assign(nearest->planes());
      memory_.planes.push(alternative);
      push_branch(best);
    }
  }
  memory_.take_back();
  return best;
}

/// Adds a node for the present planes, unless it cannot contain a better motion.
void Cycle::push_branch(const Outcome& best) noexcept {
  const std::optional<Vec3> motion = solve().motion;
  if (!motion || motion->norm() > input_.longest) return;
  if (!memory_.guides.allow(*motion) || !is_worthwhile(*motion, best.motion)) return;
  memory_.branches.push((input_.target - *motion).norm(), *motion, memory_.planes.view());
}

/// Returns true if a motion is nearer to the target than the best one, by more than a millionth of
/// the target.
bool Cycle::is_worthwhile(const Vec3& motion, const Vec3& best) const noexcept {
  const Vec3& target = input_.target;
  return (target - motion).norm() < (target - best).norm() - 1e-6 * target.norm();
}

}  // namespace keepout
