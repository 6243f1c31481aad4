// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/step/find_motion.h"

namespace keepout {

/// Whether a motion is nearer to the aim by more than a millionth of it.
inline bool is_worthwhile(const Vec3& motion, const Vec3& best, const Vec3& aim) noexcept {
  return (aim - motion).norm() < (aim - best).norm() - 1e-6 * aim.norm();
}

/// Looks for a better motion than the best one known, by branch and bound. Around each triangle
/// there are several ways, each beyond a plane of its own; a node is a choice of one way for each
/// triangle met so far, and no motion within its planes is better than the nearest one. The most
/// promising node is asked first: once the rule accepts its motion, none is better among the ways
/// considered.
///
/// Bounded by options.nodes. What it returns has stood the same test as any other motion, so the
/// bound costs quality and never safety.
template <ActivationRule A, QpSolver S>
Settled branch_and_bound(const Settled& best, A& activation, S& solver, const Motion& motion,
                         const StepOptions& options, const Surroundings& around,
                         Workspace& work) noexcept {
  // Opens a node for the planes at hand, unless it cannot lead to a better motion.
  const auto open = [&] {
    const Settled trial = solve(activation, solver, motion, options, around, work);
    if (!is_ok(trial.status) || trial.motion.norm() > around.longest) return;
    if (!is_worthwhile(trial.motion, best.motion, around.aim)) return;
    work.branches.push((around.aim - trial.motion).norm(), trial.motion, work.planes.view());
  };

  work.set_aside();
  work.branches.clear();
  open();
  for (int node = 0; node < options.nodes; ++node) {
    const Branch* branch = work.branches.pop_nearest();
    if (branch == nullptr) break;
    work.planes.assign(branch->planes());
    const Judgement judgement = activation.judge(around, branch->motion, work.planes);
    if (judgement.verdict == Judgement::Verdict::accepted) {
      // Solved once more: the solver has gone on since.
      const Settled trial = solve(activation, solver, motion, options, around, work);
      if (!is_ok(trial.status) || trial.motion != branch->motion) break;
      take_down(trial.motion, 1.0, motion, work);
      return {Status::limited, trial.motion};
    }
    if (judgement.verdict == Judgement::Verdict::blocked) continue;
    // The plane of the contact is one way around the triangle; the rule may know others.
    const TriangleId in_the_way = work.planes[work.planes.size() - 1].source;
    open();
    work.ways.clear();
    activation.ways_around(around, in_the_way, work.ways);
    for (const HalfSpace& way : work.ways) {
      work.planes.assign(branch->planes());
      work.planes.push(way);
      open();
    }
  }
  work.take_back();
  return best;
}

}  // namespace keepout
