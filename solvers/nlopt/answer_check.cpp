// SPDX-License-Identifier: BSD-3-Clause
#include "answer_check.h"

#include <algorithm>
#include <cmath>

#include "keepout/solvers/kkt.h"

namespace keepout::nlopt {

using Eigen::VectorXd;

NloptFinding AnswerCheck::judge(const VectorXd& u, const StepProblem& problem, const Solution& best,
                                double accuracy, Solution& answer) {
  if (!u.allFinite()) return NloptFinding::not_finite;
  const Eigen::Index k = problem.jacobian.rows();
  const Eigen::Index n = problem.jacobian.cols();
  // to_task v| is the length of v in task space.
  StepProblem::Matrix to_task(k + n, n);
  to_task << problem.jacobian, std::sqrt(problem.damping) * StepProblem::Matrix::Identity(n, n);
  const VectorXd given = to_task * u;

  const StepProblem onto_rows{.jacobian = {to_task.data(), k + n, n},
                              .desired = {given.data(), k + n},
                              .rows = problem.rows,
                              .bounds = problem.bounds};
  Solution feasible;
  if (nearest_.solve(onto_rows, feasible) != SolveStatus::optimal) {
    return NloptFinding::not_feasible;
  }
  const VectorXd moved = to_task * Eigen::Map<const VectorXd>(feasible.u.data(), n);
  const VectorXd goal = to_task * Eigen::Map<const VectorXd>(best.u.data(), n);
  const double asked = problem.desired.norm() / std::sqrt(static_cast<double>(n));
  const double allowed = accuracy * std::max(goal.norm(), asked);
  if (!((moved - given).norm() <= allowed)) return NloptFinding::not_feasible;
  if (!((moved - goal).norm() <= allowed)) return NloptFinding::not_optimal;

  const Solution checked{
      .u = feasible.u, .multipliers = best.multipliers, .active = best.active, .iterations = 0};
  if (!(kkt_residual(problem, checked).worst() <= accuracy)) return NloptFinding::not_optimal;
  answer = checked;
  return NloptFinding::optimal;
}

}  // namespace keepout::nlopt
