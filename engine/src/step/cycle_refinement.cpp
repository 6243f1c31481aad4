// SPDX-License-Identifier: BSD-3-Clause
//
// Refinements: better motions than the first accepted one, by linearizing its planes again and by
// branch and bound.
#include "cycle.h"

namespace keepout {

/// Linearizes the planes of an accepted motion again at that motion, at most options.refinements
/// times, as long as they allow a better motion. (The certified rule rotates the planes: Lemma 7 of
/// docs/certified-step.md.) All planes still allow the accepted motion, so nothing is lost.
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

/// Searches for a better motion than the best known one, by branch and bound. Each triangle has
/// alternative planes. A node is a choice of one plane for each triangle met so far. The motion of
/// a node is the best one within its planes. The node of least cost goes first: once the rule
/// accepts its motion, no other choice of these planes has a better motion.
///
/// Tries at most options.nodes nodes. The rule judges every motion that is returned, so the limit
/// costs quality and never safety.
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
      // Solved again, because the solver's memory holds a later solution.
      const Trial trial = solve();
      if (trial.motion != nearest->motion) break;
      memory_.store_result(request_, nearest->motion, 1.0, trial.solution, relaxation_, {});
      return {Status::limited, nearest->motion};
    }
    if (verdict == Verdict::blocked) continue;
    // The plane that the rule has added is one choice, and there may be alternatives. (In a
    // recovery the last plane may belong to a wall. Then the choice is among planes of the wall.)
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

/// Returns true if a motion is nearer to the target than the best known one, by more than a
/// millionth of the target's length.
bool Cycle::is_worthwhile(const Vec3& motion, const Vec3& best) const noexcept {
  const Vec3& target = input_.target;
  return (target - motion).norm() < (target - best).norm() - 1e-6 * target.norm();
}

}  // namespace keepout
