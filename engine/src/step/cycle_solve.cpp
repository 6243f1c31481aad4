// SPDX-License-Identifier: BSD-3-Clause
//
// The solve stage of a cycle: the quadratic program, and the relaxation of planes that contradict
// each other.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cycle.h"

namespace keepout {
namespace {

/// Returns a solver's projection of the target, corrected to the accuracy of the planes. Solvers
/// differ in their last digits, so alternating projections on the violated planes follow. For an
/// exact solver each correction is at most a last digit.
Vec3 corrected(const Vec3& motion, const Vec3& target, std::span<const HalfSpace> planes) noexcept {
  constexpr int most_corrections = 32;
  Vec3 z = motion;
  const double digits2 = 1e-30 * target.squaredNorm();
  for (int i = 0; i < most_corrections; ++i) {
    const HalfSpace* worst = nullptr;
    double violation = 0.0;
    for (const HalfSpace& plane : planes) {
      const double missing = plane.offset - plane.normal.dot(z);
      if (!(missing > violation)) continue;
      violation = missing;
      worst = &plane;
    }
    if (worst == nullptr || !(violation * violation > digits2)) break;
    z += violation * worst->normal;
  }
  return z;
}

/// Returns a motion clipped to the ball over the target, which contains all projections of the
/// target: rule 4 of docs/certified-step.md.
Vec3 clipped_to_ball(Vec3 z, const Vec3& target) noexcept {
  const double along = target.dot(z);
  const double length2 = z.squaredNorm();
  if (along < length2) z *= std::max(along, 0.0) / length2;
  return z;
}

}  // namespace

/// Returns the nearest motion that planes and guides allow. If a guide has no further half-space to
/// add, the motion may leave its region.
Cycle::Trial Cycle::solve() noexcept {
  // Without planes the target is its own projection. (A solver that does not ignore idle planes may
  // return other last digits: RuleInput::is_projected.)
  const bool is_bare = memory_.planes.empty() && !memory_.planes.overflowed();
  if (is_bare && input_.is_projected && memory_.guides.empty()) return {.motion = input_.target};
  Trial trial = solve_relaxing();
  while (trial.motion && !memory_.guides.allow(*trial.motion)) {
    budget_.spend(work::guide);
    if (!memory_.guides.exclude(*trial.motion)) break;
    trial = solve_relaxing();
  }
  return trial;
}

/// Solves for the present planes and half-spaces. If they contradict each other, relaxes those that
/// pull back, until they have a solution.
Cycle::Trial Cycle::solve_relaxing() noexcept {
  if (memory_.planes.overflowed()) return {.failure = Status::over_capacity};
  Trial trial = solve_once();
  // Planes that contradict each other, or nearly, may also end a solver at its iteration limit
  // (unsolved). Or the solution is so far away that rounding hides the motion (ill_posed).
  const auto contradict = [&] {
    return !trial.motion &&
           (trial.failure == Status::infeasible || trial.failure == Status::ill_posed ||
            trial.failure == Status::unsolved);
  };
  while (contradict() && relax()) trial = solve_once();
  if (trial.motion && !trial.motion->allFinite()) return {.failure = Status::unsolved};
  // Without a Jacobian a problem is ill-posed only if rows almost contradict each other.
  if (trial.failure == Status::ill_posed && !request_.jacobian) trial.failure = Status::infeasible;
  if (!trial.motion || end_region_ == EndRegion::motion_sphere) return trial;
  const Vec3& target = input_.target;
  trial.motion = clipped_to_ball(corrected(*trial.motion, target, memory_.solver_planes()), target);
  return trial;
}

/// Relaxes constraints that pull back, guides first. Returns true if any plane changed.
bool Cycle::relax() noexcept {
  if (memory_.guides.relax()) {
    relaxation_ = std::max(relaxation_, Relaxation::guides);
    return true;
  }
  if (!rule_.relax(memory_.planes)) return false;
  relaxation_ = Relaxation::recovery;
  return true;
}

/// Solves the quadratic program once.
Cycle::Trial Cycle::solve_once() noexcept {
  if (budget_.is_spent()) return {.failure = budget_.failure()};
  const StepProblem program = memory_.program_for(request_, input_.target, options_.damping);
  Solution solution;
  const SolveStatus solved = solver_.solve(program, solution);
  budget_.spend_solve(static_cast<std::size_t>(program.rows.cols()),
                      static_cast<std::size_t>(program.rows.rows()), solution.iterations);
  if (solved != SolveStatus::optimal) return {.failure = status_of(solved)};
  if (solution.u.size() != static_cast<std::size_t>(program.jacobian.cols())) {
    return {.failure = Status::unsolved};
  }
  const std::optional<Vec3> motion = tip_motion(program, solution, 1e-10 * options_.radius);
  if (!motion) return {.failure = Status::ill_posed};
  return {.motion = motion, .solution = solution};
}

std::optional<Vec3> tip_motion(const StepProblem& program, const Solution& solution,
                               double rounding) noexcept {
  // The relative rounding error of the sum below: each product and each sum rounds by half an
  // epsilon.
  const double digits = std::numeric_limits<double>::epsilon() *
                        (1.0 + 0.5 * static_cast<double>(program.jacobian.cols()));
  if (moves_a_point(program)) {
    const double* u = solution.u.data();
    const double size = std::abs(u[0]) + std::abs(u[1]) + std::abs(u[2]);
    if (!(digits * size <= rounding)) return std::nullopt;
    return std::optional<Vec3>(std::in_place, Eigen::Map<const Vec3>(u));
  }
  Vec3 motion = Vec3::Zero();
  double size = 0.0;  // the length of the sum if all joints moved the tip the same way
  for (Eigen::Index c = 0; c < program.jacobian.cols(); ++c) {
    const double u = solution.u[static_cast<std::size_t>(c)];
    motion += program.jacobian.col(c) * u;
    size += program.jacobian.col(c).norm() * std::abs(u);
  }
  if (!(digits * size <= rounding)) return std::nullopt;
  return motion;
}

}  // namespace keepout
