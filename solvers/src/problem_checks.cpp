// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem_checks.h"

#include <cmath>

#include "active_set_rows.h"
#include "active_set_tolerances.h"

namespace keepout {

bool shapes_agree(const StepProblem& problem) noexcept {
  const Eigen::Index n = problem.jacobian.cols();
  return n >= 1 && problem.desired.size() == problem.jacobian.rows() &&
         problem.bounds.size() == problem.rows.rows() &&
         (problem.rows.cols() == n || problem.rows.rows() == 0) &&
         (problem.planes.empty() ||
          (problem.jacobian.rows() == 3 &&
           problem.planes.size() <= static_cast<std::size_t>(problem.rows.rows())));
}

bool cost_in_range(const StepProblem& problem) noexcept {
  // Written so that NaN fails.
  const auto in_range = [](double x) { return std::abs(x) <= active_set::largest; };
  for (Eigen::Index i = 0; i < problem.jacobian.size(); ++i) {
    if (!in_range(problem.jacobian.data()[i])) return false;
  }
  for (Eigen::Index i = 0; i < problem.desired.size(); ++i) {
    if (!in_range(problem.desired[i])) return false;
  }
  return in_range(problem.damping) && problem.damping >= 0;
}

SolveStatus check_rows(const StepProblem& problem) noexcept {
  SolveStatus status = SolveStatus::optimal;
  const Eigen::Index n = problem.rows.cols();
  for (Eigen::Index i = 0; i < problem.rows.rows(); ++i) {
    const double* row = problem.rows.data() + i * n;
    double square = 0;
    for (Eigen::Index j = 0; j < n; ++j) square += row[j] * row[j];
    const SolveStatus its = active_set::row_status(row, n, square, problem.bounds[i]);
    if (its == SolveStatus::invalid_input) return its;
    if (its != SolveStatus::optimal) status = its;
  }
  return status;
}

}  // namespace keepout
