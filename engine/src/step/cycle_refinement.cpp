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

/// Looks for a better motion than the best one known, by branch and bound. Around each triangle
/// there are several ways, each beyond a plane of its own; a node is a choice of one way for each
/// triangle met so far, and no motion within its planes is better than the nearest one. The most
/// promising node is asked first: once the rule accepts its motion, none is better among the ways
/// considered.
///
/// Bounded by options.nodes. What it returns has stood the same test as any other motion, so the
/// bound costs quality and never safety.
Cycle::Trial Cycle::branch(const Trial& best) noexcept {
  work_.save();
  work_.branches.clear();
  open_branch(best);
  for (int node = 0; node < options_.nodes && !budget_.is_spent(); ++node) {
    const Branch* nearest = work_.branches.pop_nearest();
    if (nearest == nullptr) break;
    work_.planes.assign(nearest->planes());
    const Verdict verdict = rule_.judge(problem_, nearest->motion, work_.planes).verdict;
    if (verdict == Verdict::accepted) {
      // Solved once more: the solver has gone on since.
      const Trial trial = solve();
      if (!is_ok(trial.status) || trial.motion != nearest->motion) break;
      work_.store_result(motion_, trial.motion, 1.0, relaxation_, {});
      return {Status::limited, trial.motion};
    }
    if (verdict == Verdict::blocked) continue;
    // The plane of the contact is one way around the triangle; the rule may know others.
    const TriangleId in_the_way = work_.planes[work_.planes.size() - 1].source;
    open_branch(best);
    work_.ways.clear();
    rule_.ways_around(in_the_way, work_.ways);
    for (const HalfSpace& way : work_.ways) {
      work_.planes.assign(nearest->planes());
      work_.planes.push(way);
      open_branch(best);
    }
  }
  work_.restore();
  return best;
}

/// Adds a node for the present planes, unless it cannot contain a better motion.
void Cycle::open_branch(const Trial& best) noexcept {
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
