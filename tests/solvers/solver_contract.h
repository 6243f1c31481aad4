// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <ostream>
#include <span>
#include <string>

#include "keepout/solvers/kkt.h"
#include "keepout/solvers/registry.h"
#include "solvers/random_problems.h"

namespace keepout {

/// What a test prints of a backend.
inline void PrintTo(const SolverBackend& backend, std::ostream* out) { *out << backend.name; }

}  // namespace keepout

namespace keepout::test {

inline constexpr double kkt_bound = 1e-9;
inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinity = std::numeric_limits<double>::infinity();

inline Eigen::VectorXd vector(std::span<const double> values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// Where inside the feasible set the planes are built around: for tasks with a weak direction also
/// far out, where such a task sends the tool.
inline Eigen::VectorXd feasible_point(Task task, int n, Random& random) {
  const bool weak = task == Task::slanted || task == Task::uneven_columns;
  const bool far = weak && random.integer(0, 1) == 1;
  return random.vector(n) * (far ? random.log_uniform(1, 1e6) : 1.0);
}

inline Problem make_problem(Task task, Planes planes, int n, int m, Random& random) {
  Problem problem;
  make_task(problem, task, n, random);
  make_planes(problem, planes, feasible_point(task, n, random), m, random);
  return problem;
}

/// Push a point against walls: J = I.
inline Problem point_problem(const Eigen::VectorXd& desired, const StepProblem::RowMatrix& rows,
                             const Eigen::VectorXd& bounds) {
  return {.jacobian = StepProblem::Matrix::Identity(desired.size(), desired.size()),
          .desired = desired,
          .rows = rows,
          .bounds = bounds};
}

/// What every solver of the registry must do. A solver's own claim of optimality is never trusted:
/// the conditions of Karush, Kuhn and Tucker are checked from the problem.
class SolverContract : public testing::TestWithParam<SolverBackend> {
 protected:
  void SetUp() override {
    solver_ = GetParam().make();
    solver_->reserve(7, 2000);
  }

  SolveStatus solve(const Problem& problem) { return solver_->solve(problem.view(), solution_); }

  /// Optimal, and the conditions of optimality hold.
  testing::AssertionResult optimal(const Problem& problem) {
    const SolveStatus status = solve(problem);
    if (status != SolveStatus::optimal) return testing::AssertionFailure() << reason(status);
    const KktResidual residual = kkt_residual(problem.view(), solution_);
    worst_ = std::max(worst_, residual.worst());
    if (residual.worst() <= kkt_bound) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << "stationarity " << residual.stationarity << " primal " << residual.primal << " dual "
           << residual.dual << " complementarity " << residual.complementarity;
  }

  Eigen::VectorXd u() const { return vector(solution_.u); }

  std::unique_ptr<Solver> solver_;
  Solution solution_;
  double worst_ = 0;
};

inline std::string solver_name(const testing::TestParamInfo<SolverBackend>& backend) {
  return std::string(backend.param.name);
}

}  // namespace keepout::test
