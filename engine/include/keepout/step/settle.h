// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "keepout/step/branch_and_bound.h"
#include "keepout/step/find_motion.h"

namespace keepout {

/// Turns the planes of an accepted motion to where they allow a better one, as long as there is
/// one and options.refinements lasts. All planes go on allowing the motion there is, those of
/// triangles that are met on the way as well, so nothing is lost.
template <ActivationRule A, QpSolver S>
Settled refined(Settled best, A& activation, S& solver, const Motion& motion,
                const StepOptions& options, Surroundings around, Workspace& work) noexcept {
  for (int refinement = 0; refinement < options.refinements; ++refinement) {
    work.set_aside();
    around.kept = best.motion;
    if (activation.turn(around, work.earlier_planes.view(), work.planes)) {
      const Settled next = find_motion(activation, solver, motion, options, around, work);
      const bool accepted = next.status == Status::limited || next.status == Status::free;
      if (accepted && is_worthwhile(next.motion, best.motion, around.aim)) {
        best = next;
        continue;
      }
    }
    work.take_back();
    break;
  }
  return best;
}

/// Finds a motion that the rule accepts, and improves upon it.
template <ActivationRule A, QpSolver S>
Settled settle(A& activation, S& solver, const Motion& motion, const StepOptions& options,
               const Surroundings& around, Workspace& work) noexcept {
  Settled best = find_motion(activation, solver, motion, options, around, work);
  if (best.status != Status::limited) return best;
  best = refined(best, activation, solver, motion, options, around, work);
  if (options.nodes == 0) return best;
  const Settled other = branch_and_bound(best, activation, solver, motion, options, around, work);
  if (other.motion == best.motion) return best;
  return refined(other, activation, solver, motion, options, around, work);
}

}  // namespace keepout
