// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <memory>
#include <span>

#include "keepout/solvers/kkt.h"
#include "keepout/solvers/registry.h"
#include "solvers/random_problems.h"
#include "trials.h"

namespace keepout {

inline void PrintTo(const SolverBackend& backend, std::ostream* out) { *out << backend.name; }

}  // namespace keepout

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

/// The measured limits of solvers of libraries. keepout's own solver must never give up.
struct Allowance {
  int stride = 1;        // one in `stride` problems is tried, because these solvers are slow
  int most_rows = 2000;  // of a problem
  std::array<double, 3> gives_up = {0, 0, 0};  // largest fraction, by Difficulty
};

inline Allowance allowance_of(std::string_view solver) {
  // Strides are prime numbers, because the kinds of problems alternate with small periods.
  const auto stride = [](int in_long, int in_short) { return all_trials() ? in_long : in_short; };
  if (solver == "nlopt_slsqp") return {stride(7, 29), 2000, {0.01, 0.02, 0.35}};
  if (solver == "nlopt_cobyla") return {stride(163, 653), 400, {0.1, 0.3, 0.6}};
  if (solver == "nlopt_mma") return {stride(797, 3191), 20, {0.3, 0.5, 0.9}};
  return {.stride = few_trials() ? 11 : 1};
}

/// Requirements on every solver of the registry. A solver's claim of optimality is never trusted:
/// the conditions of Karush, Kuhn and Tucker are checked on the problem.
class SolverContract : public testing::TestWithParam<SolverBackend> {
 protected:
  void SetUp() override {
    solver_ = GetParam().make();
    solver_->reserve(7, 2000);
    allowance_ = allowance_of(GetParam().name);
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
    ++posed_[kind];
    const SolveStatus status = solve(problem);
    if (status == SolveStatus::infeasible) return testing::AssertionSuccess();
    if (status != SolveStatus::iteration_limit || allowance_.gives_up[kind] == 0) {
      return testing::AssertionFailure() << name(status);
    }
    ++given_up_[kind];
    return testing::AssertionSuccess();
  }

  /// Returns the tolerance that an exact solver must meet. For another solver, it is at least
  /// twenty times its accuracy, because of the condition of the problem.
  double digits(double exact) const {
    return GetParam().library == nullptr ? exact : std::max(exact, 20 * GetParam().accuracy);
  }

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
