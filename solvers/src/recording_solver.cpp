// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/solvers/recording_solver.h"

#include <new>
#include <utility>

namespace keepout {

RecordedProblem::RecordedProblem(const StepProblem& problem)
    : jacobian(problem.jacobian),
      desired(problem.desired),
      rows(problem.rows),
      bounds(problem.bounds),
      damping(problem.damping) {}

StepProblem RecordedProblem::view() const noexcept {
  return {.jacobian = {jacobian.data(), jacobian.rows(), jacobian.cols()},
          .desired = {desired.data(), desired.size()},
          .rows = {rows.data(), rows.rows(), rows.cols()},
          .bounds = {bounds.data(), bounds.size()},
          .damping = damping};
}

RecordingSolver::RecordingSolver(std::unique_ptr<Solver> solver,
                                 std::vector<RecordedProblem>& record)
    : solver_(std::move(solver)), record_(record) {}

void RecordingSolver::reserve(int variables, int rows) { solver_->reserve(variables, rows); }

SolveStatus RecordingSolver::solve(const StepProblem& problem, Solution& solution) noexcept {
  try {
    record_.emplace_back(problem);
  } catch (const std::bad_alloc&) {
    // Without memory the problem is not recorded, but the step is still solved.
  }
  return solver_->solve(problem, solution);
}

}  // namespace keepout
