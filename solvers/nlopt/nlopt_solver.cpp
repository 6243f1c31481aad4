// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/solvers/nlopt_solver.h"

#include <algorithm>
#include <new>
#include <utility>

#include "answer_check.h"
#include "contradiction.h"
#include "minimize.h"
#include "problem_checks.h"

namespace keepout {

struct NloptSolver::Workspace {
  NloptMethod method;
  int variables = 0;
  int most_rows = 0;
  nlopt::Task task;
  nlopt::CheckedAnswer answer;
  NloptReport report;

  /// The problem is in range and well-posed.
  SolveStatus solve(const StepProblem& problem, Solution& solution) {
    const nlopt::NearestPoint posed(problem, task);
    const nlopt::Attempt attempt = nlopt::minimize(method, posed);
    solution.iterations = attempt.evaluations;
    report.claim = attempt.claim;
    answer = nlopt::check_answer(posed.variables_at(attempt.z, task), problem, task, posed,
                                 accuracy(method));
    report.finding = answer.finding;
    if (answer.finding == NloptFinding::optimal) {
      solution.u = {answer.u.data(), static_cast<std::size_t>(answer.u.size())};
      solution.multipliers = answer.multipliers;
      solution.active = answer.active;
      return SolveStatus::optimal;
    }
    const double reach = std::max(posed.unconstrained.norm(), task.desired() / task.size());
    if (nlopt::contradictory(problem, posed.rows, reach)) {
      report.finding = NloptFinding::infeasible;
      return SolveStatus::infeasible;
    }
    return SolveStatus::iteration_limit;
  }
};

NloptSolver::NloptSolver(NloptMethod method) : work_(std::make_unique<Workspace>()) {
  work_->method = method;
}
NloptSolver::~NloptSolver() = default;

void NloptSolver::reserve(int variables, int rows) {
  work_->variables = std::max(variables, 0);
  work_->most_rows = std::max(rows, 0);
  work_->task.reserve(work_->variables);
}

SolveStatus NloptSolver::solve(const StepProblem& problem, Solution& solution) noexcept {
  Workspace& work = *work_;
  solution = {};
  work.report = {};
  if (!shapes_agree(problem)) return SolveStatus::invalid_input;
  if (problem.jacobian.cols() > work.variables || problem.rows.rows() > work.most_rows) {
    return SolveStatus::over_capacity;
  }
  if (!cost_in_range(problem)) return SolveStatus::invalid_input;
  const SolveStatus read = check_rows(problem);
  if (read == SolveStatus::infeasible) work.report.finding = NloptFinding::infeasible;
  if (read != SolveStatus::optimal) return read;
  if (!work.task.read(problem)) return SolveStatus::ill_posed;
  try {
    return work.solve(problem, solution);
  } catch (const std::bad_alloc&) {
    work.report = {NloptClaim::out_of_memory, NloptFinding::refused};
    return SolveStatus::iteration_limit;
  }
}

NloptReport NloptSolver::last_report() const noexcept { return work_->report; }

}  // namespace keepout
