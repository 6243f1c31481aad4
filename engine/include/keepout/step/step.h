// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "keepout/activation/activation.h"
#include "keepout/index/refine.h"
#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"
#include "keepout/step/motion.h"
#include "keepout/step/solver.h"
#include "keepout/step/stages.h"
#include "keepout/step/workspace.h"

namespace keepout {

/// What stays the same from cycle to cycle.
struct StepOptions {
  double radius;  // of the motion sphere: the farthest the tip may go in a cycle [length], > 0
  double margin = 0.0;   // distance to keep from the mesh [length], >= 0
  double damping = 0.0;  // weight of |u|^2 beside the task, for Jacobians without full column rank
};

/// invalid_input or beyond_reach for a motion that must not be attempted; free otherwise.
Status check(const Motion& motion, const StepOptions& options) noexcept;

/// What a solved increment does to the tip: dx = J u.
Vec3 tip_motion(const StepProblem& problem, const Solution& solution) noexcept;

/// One control cycle: the motion nearest to the one desired which the active planes allow.
///
///     ball -> candidates -> exact hits -> planes -> problem -> step
///
/// Works on any index, rule and solver; with final types nothing is dispatched. Allocates nothing,
/// throws nothing. On any trouble the motion is zero and the status says why. `observer` is told as
/// each stage ends.
///
/// Preconditions: `index` and `activation` are built on `mesh`; `solver` has room for the
/// workspace's capacity.
template <Index I, ActivationRule A, QpSolver S, StageObserver O = Unobserved>
Step step(const Mesh& mesh, const I& index, A& activation, S& solver, const Motion& motion,
          const StepOptions& options, Workspace& work, O&& observer = {}) noexcept {
  Step result;
  const auto stop = [&](Status why) {
    result.status = why;
    return result;
  };
  work.candidates.clear();
  work.hits.clear();
  work.planes.clear();
  if (const Status status = check(motion, options); !is_ok(status)) return stop(status);
  if (motion.jacobian.joints() > static_cast<Eigen::Index>(work.variables())) {
    return stop(Status::over_capacity);
  }

  // Planes are set back by the margin, so triangles that much farther away can still bind.
  const Ball ball{motion.tip, options.radius + options.margin};
  index.collect(ball, work.candidates);
  if (work.candidates.overflowed()) return stop(Status::over_capacity);
  refine(mesh, ball, work.candidates.view(), work.hits);
  result.triangles = work.hits.size();
  observer.ended(Stage::query);

  const Surroundings around{motion.tip, motion.desired, options.margin, work.hits.view()};
  activation.start(around, work.planes);
  observer.ended(Stage::activation);

  Vec3 trial;
  for (;;) {
    if (work.planes.overflowed()) return stop(Status::over_capacity);
    result.planes = work.planes.view();
    const StepProblem problem = work.pose(motion.desired, motion.jacobian, options.damping);
    const SolveStatus solved = solver.solve(problem, work.solution);
    if (solved != SolveStatus::optimal) return stop(status_of(solved));
    trial = tip_motion(problem, work.solution);
    const std::optional<HalfSpace> objection = activation.separate(around, trial);
    if (!objection) break;
    work.planes.push(*objection);
  }
  observer.ended(Stage::solve);

  // The planes speak only for the motion sphere. Beyond it nothing was looked at. Written so that
  // a number that is none fails the test as well.
  constexpr double rounding = 1e-9;
  if (!(trial.norm() <= options.radius * (1.0 + rounding))) return stop(Status::beyond_reach);
  result.motion = trial;
  result.increment = work.solution.u;
  result.active = work.solution.active;
  return stop(result.active.empty() ? Status::free : Status::limited);
}

}  // namespace keepout
