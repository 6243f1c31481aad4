// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "keepout/activation/activation.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"
#include "keepout/step/solver.h"
#include "keepout/step/workspace.h"

namespace keepout {

/// What a search for a motion came to.
struct Settled {
  Status status;  // how it ended
  Vec3 motion;    // of the tip; zero unless the status is ok [length]

  /// No motion, and why.
  static Settled stopped(Status why) noexcept { return {why, Vec3::Zero()}; }
};

/// What a solved increment does to the tip: dx = J u. Nothing when the joints would move so far,
/// one against the other, that more than `rounding` of it is lost in their digits.
std::optional<Vec3> tip_motion(const StepProblem& problem, const Solution& solution,
                               double rounding) noexcept;

/// A projection of the aim as exact as its planes: what a solver left undone is made up for, and
/// the motion ends in the ball over the aim, where triangles were looked for.
Vec3 sharpened(const Vec3& motion, const Vec3& aim, std::span<const HalfSpace> planes) noexcept;

/// The plane that bounds motions in one direction, just short of the longest.
HalfSpace bound_of(const Vec3& motion, double longest) noexcept;

/// Whether any part of a motion that satisfies the caller's rows satisfies them too: none asks for
/// motion.
bool allow_parts(const std::optional<ExtraRows>& rows) noexcept;

/// Whether the answer is the projection of the aim on the planes, to the last bit: so it is with a
/// solver that skips idle rows, unless joints, rows of the caller's or damping have a say.
inline bool is_projection(const Surroundings& around, const StepOptions& options) noexcept {
  return around.needed == NeededPlanes::in_the_way && options.damping == 0.0;
}

/// The nearest motion that the planes allow; not judged yet. free, or what went wrong.
template <ActivationRule A, QpSolver S>
Settled solve(A& activation, S& solver, const Motion& motion, const StepOptions& options,
              const Surroundings& around, Workspace& work) noexcept {
  if (work.planes.overflowed()) return Settled::stopped(Status::over_capacity);
  // The projection of the aim on no plane: it needs no solver.
  if (work.planes.empty() && is_projection(around, options)) {
    work.solution = {};
    return {Status::free, around.aim};
  }
  const PlaneRows rows = reads_planes(solver) ? PlaneRows::left_out : PlaneRows::written;
  std::optional<Vec3> answer;
  const auto attempt = [&] {
    const StepProblem problem = work.pose(motion, around.aim, options.damping, rows);
    work.solution = {};
    const SolveStatus solved = solver.solve(problem, work.solution);
    if (solved != SolveStatus::optimal) return status_of(solved);
    const auto variables = static_cast<std::size_t>(problem.jacobian.cols());
    if (work.solution.u.size() != variables) return Status::unsolved;
    answer = tip_motion(problem, work.solution, 1e-10 * options.radius);
    return answer ? Status::free : Status::ill_posed;
  };
  Status solved = attempt();
  // Planes that contradict each other, or all but, so that what satisfies them is out of the world.
  const bool contradict = solved == Status::infeasible || solved == Status::ill_posed;
  if (contradict && activation.relax(work.planes)) solved = attempt();
  if (!is_ok(solved)) return Settled::stopped(solved);
  if (!answer->allFinite()) return Settled::stopped(Status::unsolved);
  if (around.reach == Reach::sphere) return {Status::free, *answer};
  return {Status::free, sharpened(*answer, around.aim, work.planes.view())};
}

/// Takes down the last solution as the answer: `share` of it.
inline void take_down(const Vec3& tip_motion, double share, const Motion& motion,
                      Workspace& work) noexcept {
  if (motion.jacobian) {
    work.note(work.solution, share);
  } else {
    work.note(work.solution, tip_motion);
  }
}

/// Solves, and as long as the rule objects to the trial motion, solves again with its plane.
template <ActivationRule A, QpSolver S>
Settled find_motion(A& activation, S& solver, const Motion& motion, const StepOptions& options,
                    const Surroundings& around, Workspace& work) noexcept {
  Settled trial = Settled::stopped(Status::unsolved);
  double free_share = 0.0;  // of the trial
  // A sound rule needs a handful of rounds, in the tip of a cone some hundred; the limit bounds an
  // unsound one.
  constexpr int most_rounds = 256;
  for (int round = 0; round < most_rounds; ++round) {
    const Settled next = solve(activation, solver, motion, options, around, work);
    if (!is_ok(next.status)) {
      // Part of the last trial may be made all the same. With joints its increment is gone.
      if (!(free_share > 0.0) || motion.jacobian) return next;
      work.solution = {};
      break;
    }
    trial = next;
    // Beyond the sphere nothing was looked at.
    if (trial.motion.norm() > around.longest) {
      work.planes.push(bound_of(trial.motion, around.longest));
      free_share = 0.0;
      continue;
    }
    const Judgement judgement = activation.judge(around, trial.motion, work.planes);
    if (judgement.verdict == Judgement::Verdict::accepted) {
      take_down(trial.motion, 1.0, motion, work);
      if (!work.solution.active.empty()) trial.status = Status::limited;
      return trial;
    }
    free_share = judgement.free_share;
    if (judgement.verdict == Judgement::Verdict::blocked) break;
  }

  // The part of the last trial up to the first contact, provided that it stands the same test.
  const double share = free_share * (1.0 - 1e-9);
  const Vec3 part = share * trial.motion;
  if (!(share > 0.0) || !allow_parts(motion.rows) ||
      activation.judge(around, part, work.planes).verdict != Judgement::Verdict::accepted) {
    return Settled::stopped(Status::unsolved);
  }
  take_down(part, share, motion, work);
  return {Status::fallback, part};
}

}  // namespace keepout
