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

/// Returns a solver's projection of the target, corrected to the accuracy of the planes: by
/// alternating projections on the planes that are violated, as solvers differ in their last digits.
/// For an exact solver each correction is at most a last digit.
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

/// Returns a motion that ends in the ball over the target, in which the index was searched: rule 4
/// of docs/certified-step.md, the clip.
Vec3 clipped_to_ball(Vec3 z, const Vec3& target) noexcept {
  const double along = target.dot(z);
  const double length2 = z.squaredNorm();
  if (along < length2) z *= std::max(along, 0.0) / length2;
  return z;
}

/// Returns the work units of a solve: each iteration visits all rows, and the first one the square
/// of the Jacobian.
std::size_t work_of(const StepProblem& problem, const Solution& solution) noexcept {
  constexpr std::size_t numbers_in_a_unit = 48;  // as of sixteen planes
  const auto numbers = static_cast<std::size_t>(problem.rows.rows() * problem.rows.cols());
  const auto variables = static_cast<std::size_t>(problem.rows.cols());
  const auto iterations = static_cast<std::size_t>(std::max(solution.iterations, 0));
  return variables * variables * variables / 512 +
         (1 + iterations) * (4 + numbers / numbers_in_a_unit);
}

}  // namespace

/// Returns the nearest motion that planes and guides allow, which the rule has not judged yet, with
/// status free, or a failure. If no half-space of a guide is left to add, the motion may leave the
/// region of the guide.
Cycle::Trial Cycle::solve() noexcept {
  // Without planes the projection of the target is the target.
  const bool is_bare = work_.planes.empty() && !work_.planes.overflowed();
  if (is_bare && problem_.is_projected && work_.guides.empty()) {
    work_.solution = {};
    return {Status::free, problem_.target};
  }
  Trial trial = solve_relaxing();
  if (work_.guides.empty()) return trial;
  while (is_ok(trial.status) && !work_.guides.allow(trial.motion)) {
    budget_.spend(1);
    if (!work_.guides.exclude(trial.motion)) break;
    trial = solve_relaxing();
  }
  return trial;
}

Cycle::Trial Cycle::solve_relaxing() noexcept {
  if (work_.planes.overflowed()) return {Status::over_capacity, Vec3::Zero()};
  std::optional<Vec3> motion;
  Status solved = solve_once(motion);
  // If planes contradict each other, or nearly, the solver may also find a point far away, or reach
  // its iteration limit.
  const auto contradict = [&] {
    return solved == Status::infeasible || solved == Status::ill_posed ||
           solved == Status::unsolved;
  };
  while (contradict() && relax()) solved = solve_once(motion);
  if (is_ok(solved) && !motion->allFinite()) solved = Status::unsolved;
  // Without a Jacobian only rows that almost contradict each other make a problem ill-posed.
  if (solved == Status::ill_posed && !request_.jacobian) solved = Status::infeasible;
  if (!is_ok(solved)) return {solved, Vec3::Zero()};
  if (problem_.end_region == EndRegion::motion_sphere) return {Status::free, *motion};
  const Vec3& target = problem_.target;
  return {Status::free, clipped_to_ball(corrected(*motion, target, work_.posed()), target)};
}

/// Relaxes constraints that pull back: guides first. Returns true if any plane changed.
bool Cycle::relax() noexcept {
  if (work_.guides.relax()) {
    relaxation_ = std::max(relaxation_, Relaxation::guides);
    return true;
  }
  if (!rule_.relax(work_.planes)) return false;
  relaxation_ = Relaxation::recovery;
  return true;
}

Status Cycle::solve_once(std::optional<Vec3>& motion) noexcept {
  if (budget_.is_spent()) return budget_.status_at_end();
  const StepProblem problem = work_.pose(request_, problem_.target, options_.damping);
  work_.solution = {};
  const SolveStatus solved = solver_.solve(problem, work_.solution);
  budget_.spend(work_of(problem, work_.solution));
  if (solved != SolveStatus::optimal) return status_of(solved);
  if (work_.solution.u.size() != static_cast<std::size_t>(problem.jacobian.cols())) {
    return Status::unsolved;
  }
  motion = tip_motion(problem, work_.solution, 1e-10 * options_.radius);
  return motion ? Status::free : Status::ill_posed;
}

std::optional<Vec3> tip_motion(const StepProblem& problem, const Solution& solution,
                               double rounding) noexcept {
  // The relative rounding error of the sum below: each product and each sum rounds by half of it.
  const double digits = std::numeric_limits<double>::epsilon() *
                        (1.0 + 0.5 * static_cast<double>(problem.jacobian.cols()));
  if (moves_a_point(problem)) {
    const double* u = solution.u.data();
    const double size = std::abs(u[0]) + std::abs(u[1]) + std::abs(u[2]);
    if (!(digits * size <= rounding)) return std::nullopt;
    return std::optional<Vec3>(std::in_place, Eigen::Map<const Vec3>(u));
  }
  Vec3 motion = Vec3::Zero();
  double size = 0.0;  // of the sum: the motion if all joints moved the tip the same way
  for (Eigen::Index c = 0; c < problem.jacobian.cols(); ++c) {
    const double u = solution.u[static_cast<std::size_t>(c)];
    motion += problem.jacobian.col(c) * u;
    size += problem.jacobian.col(c).norm() * std::abs(u);
  }
  if (!(digits * size <= rounding)) return std::nullopt;
  return motion;
}

}  // namespace keepout
