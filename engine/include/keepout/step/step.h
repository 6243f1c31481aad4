// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

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
  double radius = 0.0;   // of the motion sphere: how far the tip may go in a cycle [length], > 0
  double margin = 0.0;   // distance to keep from the mesh [length], >= 0
  double damping = 0.0;  // weight of |u|^2 beside the task, for Jacobians without full column rank
};

/// invalid_input or beyond_reach for a motion that must not be attempted; free otherwise.
Status check(const Motion& motion, const StepOptions& options) noexcept;

/// How far the tip may go, all told: a step clipped to the radius may be longer by its rounding.
constexpr double reach(const StepOptions& options) noexcept {
  return options.radius * (1.0 + 1e-9);
}

/// What a position may be off by after a step: the rounding of tip + motion, some 1e-16 of the
/// tip's coordinates, and the solver's, some 1e-13 of the motion; both taken a thousand times.
/// [length]
double position_rounding(const Vec3& tip, const StepOptions& options) noexcept;

/// What a solved increment does to the tip: dx = J u. Nothing when the joints would move so far,
/// one against the other, that more than `rounding` of it is lost in their digits.
std::optional<Vec3> tip_motion(const StepProblem& problem, const Solution& solution,
                               double rounding) noexcept;

/// Whether a motion satisfies all planes, to within half of the rounding of a position.
bool satisfies(const Vec3& motion, std::span<const HalfSpace> planes, double rounding) noexcept;

/// What the rule and the solver settle on: the last part of step.
struct Settled {
  Status status;
  Vec3 motion;  // of the tip [length]
};

/// Solves, and as long as the rule objects to the trial motion, solves again with its plane.
template <ActivationRule A, QpSolver S>
Settled solve(A& activation, S& solver, const Motion& motion, const StepOptions& options,
              const Surroundings& around, Workspace& work) noexcept {
  // A sound rule needs a handful of rounds; the limit bounds the work of an unsound one.
  constexpr int most_rounds = 256;
  for (int round = 0; round < most_rounds; ++round) {
    if (work.planes.overflowed()) return {Status::over_capacity, Vec3::Zero()};
    const StepProblem problem = work.pose(motion, options.damping);
    work.solution = {};
    const SolveStatus solved = solver.solve(problem, work.solution);
    if (solved != SolveStatus::optimal) return {status_of(solved), Vec3::Zero()};
    const auto variables = static_cast<std::size_t>(problem.jacobian.cols());
    if (work.solution.u.size() != variables) return {Status::unsolved, Vec3::Zero()};
    const std::optional<Vec3> trial = tip_motion(problem, work.solution, around.rounding);
    if (!trial) return {Status::ill_posed, Vec3::Zero()};
    const std::optional<HalfSpace> objection = activation.separate(around, *trial);
    if (!objection) {
      return {work.solution.active.empty() ? Status::free : Status::limited, *trial};
    }
    work.planes.push(*objection);
  }
  return {Status::unsolved, Vec3::Zero()};
}

/// One control cycle: the motion nearest to the one desired which the active planes allow.
///
///     ball -> candidates -> exact hits -> planes -> problem -> step
///
/// Works on any index, rule and solver; with final types nothing is dispatched. Allocates nothing,
/// throws nothing. On any trouble the motion is zero and the status says why; no solver is taken at
/// its word. `observer` is told as each stage ends.
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
  if (motion.jacobian && motion.jacobian->joints() > work.variables()) {
    return stop(Status::over_capacity);
  }

  // Planes are set back by the margin, so triangles that much farther away can still bind.
  const Ball ball{motion.tip, reach(options) + options.margin};
  index.collect(ball, work.candidates);
  if (work.candidates.overflowed()) return stop(Status::over_capacity);
  refine(mesh, ball, work.candidates.view(), work.hits);
  result.triangles = work.hits.size();
  observer.ended(Stage::query);

  const double rounding = position_rounding(motion.tip, options);
  const Surroundings around{motion.tip, motion.desired, options.margin, rounding, work.hits.view()};
  activation.start(around, work.planes);
  observer.ended(Stage::activation);

  const auto [status, trial] = solve(activation, solver, motion, options, around, work);
  observer.ended(Stage::solve);
  result.planes = work.planes.view();
  if (!is_ok(status)) return stop(status);
  if (!satisfies(trial, work.planes.view(), rounding)) return stop(Status::unsolved);
  // The planes speak only for the motion sphere: beyond it nothing was looked at. Written so that
  // a number that is none fails the test as well.
  if (!(trial.norm() <= reach(options))) return stop(Status::beyond_reach);
  result.motion = trial;
  result.increment = work.solution.u;
  result.active = work.solution.active;
  return stop(status);
}

}  // namespace keepout
