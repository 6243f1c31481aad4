// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/solvers/nlopt_solver.h"

#include <array>
#include <new>

#include "answer_check.h"
#include "minimize.h"
#include "nearest_point.h"

namespace keepout {

struct NloptSolver::Workspace {
  explicit Workspace(NloptMethod which) : method(which) {}

  NloptMethod method;
  ActiveSet ours;
  nlopt::AnswerCheck check;
  NloptReport report;
};

NloptSolver::NloptSolver(NloptMethod method) : work_(std::make_unique<Workspace>(method)) {}
NloptSolver::~NloptSolver() = default;

void NloptSolver::reserve(int variables, int rows) {
  work_->ours.reserve(variables, rows);
  work_->check.reserve(variables, rows);
}

SolveStatus NloptSolver::solve(const StepProblem& problem, Solution& solution) noexcept {
  NloptReport& report = work_->report;
  report = {};
  solution = {};
  Solution best;
  const SolveStatus status = work_->ours.solve(problem, best);
  if (status != SolveStatus::optimal && status != SolveStatus::infeasible) return status;
  try {
    const nlopt::NearestPoint posed(problem);
    const nlopt::Attempt attempt = nlopt::minimize(work_->method, posed);
    report = {attempt.claim, NloptFinding::infeasible};
    if (status == SolveStatus::optimal) {
      report.finding = work_->check.judge(posed.variables_at(attempt.z), problem, best,
                                          accuracy(work_->method), solution);
    }
    solution.iterations = attempt.evaluations;
  } catch (const std::bad_alloc&) {
    report = {"OUT_OF_MEMORY", NloptFinding::refused};
    return SolveStatus::iteration_limit;
  }
  if (status == SolveStatus::infeasible) return status;
  return report.finding == NloptFinding::optimal ? status : SolveStatus::iteration_limit;
}

NloptReport NloptSolver::last_report() const noexcept { return work_->report; }

std::string_view name(NloptFinding finding) noexcept {
  constexpr std::array<std::string_view, 6> names{
      "refused", "optimal", "not optimal", "not feasible", "not finite", "infeasible, proven"};
  const auto at = static_cast<std::size_t>(finding);
  return at < names.size() ? names[at] : "unknown";
}

}  // namespace keepout
