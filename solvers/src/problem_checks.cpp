// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem_checks.h"

#include <cmath>

#include "active_set_tolerances.h"

namespace keepout {

bool shapes_agree(const StepProblem& problem) noexcept {
  const Eigen::Index n = problem.jacobian.cols();
  return n >= 1 && problem.desired.size() == problem.jacobian.rows() &&
         problem.bounds.size() == problem.rows.rows() &&
         (problem.rows.cols() == n || problem.rows.rows() == 0);
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

}  // namespace keepout
