// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <ostream>
#include <span>

#include "keepout/fixtures/random_problems.h"
#include "keepout/solvers/kkt.h"
#include "keepout/solvers/registry.h"
#include "keepout/testing/trials.h"

namespace keepout::test {

inline Eigen::VectorXd vector(std::span<const double> values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// Returns the point around which the planes are built. For tasks with a weak direction, it may be
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

/// Returns the problem of a point that is pushed against planes: J = I.
inline Problem point_problem(const Eigen::VectorXd& desired, const StepProblem::RowMatrix& rows,
                             const Eigen::VectorXd& bounds) {
  return {.jacobian = StepProblem::Matrix::Identity(desired.size(), desired.size()),
          .desired = desired,
          .rows = rows,
          .bounds = bounds};
}

/// The difficulty of a problem for a solver that is not exact.
enum class Difficulty { plain, tangled, weak };

/// Returns weak for a task of condition 1e6, tangled for almost parallel planes and for slabs that
/// rounding may close.
inline Difficulty difficulty_of(Task task, Planes planes) {
  if (task == Task::slanted || task == Task::uneven_columns) return Difficulty::weak;
  return planes == Planes::near_parallel || planes == Planes::slabs ? Difficulty::tangled
                                                                    : Difficulty::plain;
}

/// The limits of a solver that is slow or not exact. By default, it must answer every problem.
struct Allowance {
  int stride = few_trials() ? 11 : 1;  // one in `stride` problems is tried
  int most_rows = 2000;                // of a problem
  /// The largest fraction of problems on which it gives up (iteration_limit), by Difficulty.
  std::array<double, 3> gives_up = {0, 0, 0};
  bool proves_infeasible = true;  // false: it gives up on infeasible problems
};

/// A solver and the limits that its tests allow.
struct SolverUnderTest : SolverBackend {
  Allowance allowance = {};
};

inline void PrintTo(const SolverUnderTest& solver, std::ostream* out) { *out << solver.name; }

/// The requirements on a solver. A solver's claim of optimality is never trusted:
/// the conditions of Karush, Kuhn and Tucker are checked on the problem.
class SolverContract : public testing::TestWithParam<SolverUnderTest> {
 protected:
  void SetUp() override {
    solver_ = GetParam().make();
    solver_->reserve(7, 2000);
    allowance_ = GetParam().allowance;
  }

  /// Checks that the solver gave up at most as often as allowed, if it had 12 problems or more.
  void TearDown() override {
    for (std::size_t i = 0; i < posed_.size(); ++i) {
      if (posed_[i] < 12) continue;
      EXPECT_LE(given_up_[i], allowance_.gives_up[i] * posed_[i])
          << "of " << posed_[i] << " of difficulty " << i;
    }
  }

  SolveStatus solve(const Problem& problem) { return solver_->solve(problem.view(), solution_); }

  /// Succeeds if the solver returns optimal and the conditions of optimality hold.
  testing::AssertionResult optimal(const Problem& problem) {
    return checked(problem, solve(problem));
  }

  testing::AssertionResult checked(const Problem& problem, SolveStatus status) {
    if (status != SolveStatus::optimal) return testing::AssertionFailure() << name(status);
    const KktResidual residual = kkt_residual(problem.view(), solution_);
    if (residual.worst() <= GetParam().accuracy) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << "stationarity " << residual.stationarity << " primal " << residual.primal << " dual "
           << residual.dual << " complementarity " << residual.complementarity;
  }

  /// Like optimal(), but the solver may give up as often as allowed. For feasible problems.
  testing::AssertionResult optimal_or_given_up(const Problem& problem,
                                               Difficulty difficulty = Difficulty::plain) {
    const auto kind = static_cast<std::size_t>(difficulty);
    ++posed_[kind];
    const SolveStatus status = solve(problem);
    gave_up_ = allowance_.gives_up[kind] > 0 && status == SolveStatus::iteration_limit;
    if (!gave_up_) return checked(problem, status);
    ++given_up_[kind];
    return testing::AssertionSuccess();
  }

  /// Succeeds if the solver returns infeasible, or gives up as often as allowed.
  testing::AssertionResult infeasible_or_given_up(const Problem& problem, Difficulty difficulty) {
    const auto kind = static_cast<std::size_t>(difficulty);
    const SolveStatus status = solve(problem);
    const bool gave_up = status == SolveStatus::iteration_limit;
    if (gave_up && !allowance_.proves_infeasible) return testing::AssertionSuccess();
    ++posed_[kind];
    if (status == SolveStatus::infeasible) return testing::AssertionSuccess();
    if (!gave_up || allowance_.gives_up[kind] == 0) {
      return testing::AssertionFailure() << name(status);
    }
    ++given_up_[kind];
    return testing::AssertionSuccess();
  }

  /// Returns the tolerance that an exact solver must meet. For another solver, it is at least
  /// twenty times its accuracy, because of the condition of the problem.
  double digits(double exact) const {
    return is_exact() ? exact : std::max(exact, 20 * GetParam().accuracy);
  }

  /// Returns true if the solver states the accuracy of keepout's own.
  bool is_exact() const { return GetParam().accuracy <= 1e-9; }

  /// Returns n if one in n of an exact solver's problems is tried.
  int stride() const { return allowance_.stride; }

  Eigen::VectorXd u() const { return vector(solution_.u); }

  std::unique_ptr<Solver> solver_;
  Solution solution_;
  Allowance allowance_;
  bool gave_up_ = false;                        // on the last problem
  std::array<double, 3> posed_{}, given_up_{};  // by Difficulty
};

}  // namespace keepout::test
