// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <span>
#include <utility>

#include "keepout/activation/activation.h"
#include "keepout/index/refine.h"
#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"
#include "keepout/step/settle.h"
#include "keepout/step/solver.h"
#include "keepout/step/stages.h"
#include "keepout/step/workspace.h"

namespace keepout {

/// invalid_input or beyond_reach for a motion that must not be attempted; free otherwise.
Status check(const Motion& motion, const StepOptions& options) noexcept;

/// What a position may be off by after a step: the rounding of tip + motion, some 1e-16 of the
/// tip's coordinates, and the solver's, some 1e-13 of the motion; both taken a thousand times.
/// [length]
inline double position_rounding(const Vec3& tip, const StepOptions& options) noexcept {
  return 1e-12 * (tip.lpNorm<1>() + distance_kept(options)) + 1e-10 * options.radius;
}

/// What the rule is to be asked about a motion, before triangles are looked for. `projections`: how
/// far the rule's motions can lead when they are projections of the aim.
Surroundings surroundings_of(const Motion& motion, const StepOptions& options,
                             Reach projections) noexcept;

/// What an opening means for the step; free where it may go on.
Status status_of(Opening::Stance stance) noexcept;

/// Finds the triangles that matter for the aim, and lets the rule begin with them.
template <Index I, ActivationRule A, StageObserver O>
Opening open(const Mesh& mesh, const I& index, A& activation, Surroundings& around, Workspace& work,
             O& observer) noexcept {
  work.candidates.clear();
  work.hits.clear();
  work.planes.clear();
  around.ball = activation.region(around);
  if (!activation.searches()) {
    index.collect(around.ball, work.candidates);
    if (work.candidates.overflowed()) return {Opening::Stance::over_capacity};
    refine(mesh, around.ball, work.candidates.view(), work.hits);
    around.hits = work.hits.view();
  }
  observer.ended(Stage::query);
  const Opening opening = activation.start(around, work.planes);
  observer.ended(Stage::activation);
  return opening;
}

/// See step. Precondition: check(motion, options) is ok.
template <Index I, ActivationRule A, QpSolver S, StageObserver O = Unobserved>
Step step_as_checked(const Mesh& mesh, const I& index, A& activation, S& solver,
                     const Motion& motion, const StepOptions& options, Workspace& work,
                     O&& observer = {}) noexcept {
  Step result;
  work.planes.clear();
  if ((motion.jacobian && motion.jacobian->joints() > work.variables()) ||
      (motion.rows && motion.rows->count() > work.extra_rows())) {
    result.status = Status::over_capacity;
    return result;
  }

  using Stance = Opening::Stance;
  Surroundings around = surroundings_of(motion, options, activation.reach());
  const bool projects = !motion.jacobian && !motion.rows;
  if (projects && skips_idle_rows(solver)) around.needed = NeededPlanes::in_the_way;
  Opening opening = open(mesh, index, activation, around, work, observer);
  // More triangles than there is room for: a shorter way has fewer. The sphere is not for less than
  // the motion asked for.
  constexpr int most_halvings = 8;
  int halvings = 0;
  const auto open_shorter = [&] {
    while (opening.stance == Stance::over_capacity && halvings < most_halvings) {
      around.aim *= 0.5;
      if (around.reach == Reach::sphere) around.longest *= 0.5;
      ++halvings;
      opening = open(mesh, index, activation, around, work, observer);
    }
  };
  if (around.reach == Reach::thales) {
    around.searched = opening.stance == Stance::over_capacity ? around.reach : around.searched;
    open_shorter();
  }
  result.distance = opening.distance;
  // Too close: the way out is the aim, and has surroundings of its own.
  const bool recovering = opening.stance == Stance::too_close;
  if (recovering) {
    around.aim = opening.aim;
    // What leads out is no projection of it. But it need not lead much farther.
    around.reach = around.searched = Reach::sphere;
    around.longest = std::min(around.longest, 2.0 * around.aim.norm());
    opening = open(mesh, index, activation, around, work, observer);
    open_shorter();
  }
  result.status = status_of(opening.stance);
  if (!is_ok(result.status)) {
    result.triangles = activation.triangles(around);
    return result;
  }

  const Settled settled = settle(activation, solver, motion, options, around, work);
  result.triangles = activation.triangles(around);
  observer.ended(Stage::solve);
  result.planes = work.planes.view();
  result.status = settled.status;
  if (!is_ok(result.status)) return result;
  result.motion = settled.motion;
  result.increment = work.increment();
  result.active = work.active();
  if (halvings > 0) result.status = Status::fallback;
  if (recovering) result.status = Status::recovering;
  return result;
}

/// One control cycle: the motion nearest to the one desired which the rule allows.
///
///     ball -> candidates -> exact hits -> planes -> problem -> step
///
/// Works on any index, rule and solver; with final types nothing is dispatched. Allocates nothing,
/// throws nothing. On any trouble the motion is zero and the status says why; no solver is taken at
/// its word. `observer` is told as each stage ends.
///
/// Preconditions: `index` and `activation` are built on `mesh`; `activation` has room for the
/// workspace's triangles, `solver` for its planes and extra rows.
template <Index I, ActivationRule A, QpSolver S, StageObserver O = Unobserved>
Step step(const Mesh& mesh, const I& index, A& activation, S& solver, const Motion& motion,
          const StepOptions& options, Workspace& work, O&& observer = {}) noexcept {
  const Status checked = check(motion, options);
  if (!is_ok(checked)) return {.status = checked};
  return step_as_checked(mesh, index, activation, solver, motion, options, work,
                         std::forward<O>(observer));
}

}  // namespace keepout
