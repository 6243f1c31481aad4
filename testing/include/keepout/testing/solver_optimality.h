// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Problems solved by hand, and many that are checked by the conditions of optimality.

#include <Eigen/LU>
#include <optional>

#include "keepout/testing/solver_trials.h"

namespace keepout::test {

using Real = long double;
using RealVector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
using RealMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

/// Feasibility of a vertex that is computed with a 64-bit mantissa from numbers of size 1.
inline constexpr Real tolerance = 1e-13L;

/// Returns the minimizer by trying every set of active rows in extended precision: exponential in
/// m, and too simple to be wrong. Empty if no set of rows yields a feasible point.
inline std::optional<Eigen::VectorXd> enumerate_minimum(const StepProblem& problem) {
  const Eigen::Index n = problem.jacobian.cols();
  const Eigen::Index m = problem.rows.rows();
  const RealMatrix jacobian = problem.jacobian.cast<Real>();
  const RealVector desired = problem.desired.cast<Real>();
  const RealMatrix rows = problem.rows.cast<Real>();
  const RealVector bounds = problem.bounds.cast<Real>();
  const RealMatrix hessian =
      jacobian.transpose() * jacobian + RealMatrix::Identity(n, n) * Real{problem.damping};
  const RealVector pull = jacobian.transpose() * desired;

  std::optional<Eigen::VectorXd> best;
  Real least = std::numeric_limits<Real>::infinity();
  for (unsigned set = 0; set < 1U << m; ++set) {
    const Eigen::Index active = __builtin_popcount(set);
    if (active > n) continue;
    RealMatrix system = RealMatrix::Zero(n + active, n + active);
    RealVector right(n + active);
    system.topLeftCorner(n, n) = hessian;
    right.head(n) = pull;
    for (Eigen::Index i = 0, at = n; i < m; ++i) {
      if ((set >> i & 1U) == 0) continue;
      system.row(at).head(n) = rows.row(i);
      system.col(at).head(n) = rows.row(i).transpose();
      right[at++] = bounds[i];
    }
    const Eigen::FullPivLU<RealMatrix> lu(system);
    if (!lu.isInvertible()) continue;  // another set spans the same rows
    const RealVector u = lu.solve(right).head(n);
    if (m > 0 && (rows * u - bounds).minCoeff() < -tolerance) continue;
    const Real cost = (jacobian * u - desired).squaredNorm() + problem.damping * u.squaredNorm();
    if (cost < least) {
      least = cost;
      best = u.cast<double>();
    }
  }
  return best;
}

TEST_P(SolverContract, WithoutRowsTheTaskIsMetExactly) {
  const Problem problem =
      point_problem(Eigen::Vector3d(1, -2, 3), StepProblem::RowMatrix(0, 3), Eigen::VectorXd(0));
  ASSERT_TRUE(optimal(problem));
  EXPECT_LE((u() - Eigen::Vector3d(1, -2, 3)).norm(), digits(0));
  EXPECT_TRUE(solution_.active.empty());
}

TEST_P(SolverContract, PushIntoTheCornerOfABoxStopsAtTheCorner) {
  // The box -1 <= u <= 1 with target (3, 0.5, -2) has its optimum at (1, 0.5, -1). Its gradient
  // (-4, 0, 2) is balanced by row 0 (-x >= -1) with 4 and row 5 (z >= -1) with 2.
  StepProblem::RowMatrix rows(6, 3);
  rows << -1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1;
  const Problem problem =
      point_problem(Eigen::Vector3d(3, 0.5, -2), rows, Eigen::VectorXd::Constant(6, -1));
  ASSERT_TRUE(optimal(problem));
  EXPECT_LT((u() - Eigen::Vector3d(1, 0.5, -1)).norm(), digits(1e-15));
  ASSERT_EQ(solution_.active.size(), 2U);
  EXPECT_EQ(solution_.active[0], 0U);
  EXPECT_EQ(solution_.active[1], 5U);
  EXPECT_NEAR(solution_.multipliers[0], 4, digits(1e-14));
  EXPECT_NEAR(solution_.multipliers[1], 2, digits(1e-14));
}

TEST_P(SolverContract, PushAcrossAnEdgeSlidesAlongTheEdge) {
  // A wedge z >= x, z >= -x with its edge along y: only this part of (0, 1, -1) is left.
  StepProblem::RowMatrix rows(2, 3);
  rows << -1, 0, 1, 1, 0, 1;
  const Problem problem = point_problem(Eigen::Vector3d(0, 1, -1), rows, Eigen::VectorXd::Zero(2));
  ASSERT_TRUE(optimal(problem));
  EXPECT_LT((u() - Eigen::Vector3d(0, 1, 0)).norm(), digits(1e-15));
  ASSERT_EQ(solution_.multipliers.size(), 2U);
  EXPECT_NEAR(solution_.multipliers[0], 1, digits(1e-14));
  EXPECT_NEAR(solution_.multipliers[1], 1, digits(1e-14));
}

TEST_P(SolverContract, DampingShortensTheMotion) {
  // min (u - 1)^2 + 3 u^2 is at 1/4.
  Problem problem =
      point_problem(Eigen::VectorXd::Ones(1), StepProblem::RowMatrix(0, 1), Eigen::VectorXd(0));
  problem.damping = 3;
  ASSERT_TRUE(optimal(problem));
  EXPECT_NEAR(u()[0], 0.25, digits(1e-16));
}

TEST_P(SolverContract, DampingAlonePicksTheShortestFeasibleMotion) {
  // Without task rows, the optimum is the point of x + y >= 2 that is nearest to 0.
  Problem problem;
  problem.jacobian.resize(0, 2);
  problem.desired.resize(0);
  problem.rows = StepProblem::RowMatrix::Ones(1, 2);
  problem.bounds = Eigen::VectorXd::Constant(1, 2);
  problem.damping = 1e-3;
  ASSERT_TRUE(optimal(problem));
  EXPECT_LT((u() - Eigen::Vector2d(1, 1)).norm(), digits(1e-15));
}

TEST_P(SolverContract, AVertexAtRestWithNothingAskedStaysAtRest) {
  const Problem problem = point_problem(
      Eigen::Vector3d::Zero(), StepProblem::RowMatrix::Identity(3, 3), Eigen::VectorXd::Zero(3));
  ASSERT_TRUE(optimal(problem));
  EXPECT_EQ(u(), Eigen::VectorXd(Eigen::Vector3d::Zero()));
}

TEST_P(SolverContract, ThousandsOfProblemsOfEveryClassAreOptimal) {
  // 7 tasks x 9 kinds of planes x 1600 = 100800 problems. The planes of every kind have a common
  // point up to rounding, so "infeasible" is always wrong. A solver may give up at a vertex, or in
  // a slab that rounding may close. keepout's own solver never does.
  for (const Task task : tasks) {
    for (const Planes planes : plane_kinds) {
      for (int i = 0; i < 1600; i += stride()) {
        Random random(static_cast<std::uint64_t>(i) * 100 + static_cast<std::uint64_t>(task) * 10 +
                      static_cast<std::uint64_t>(planes));
        const int n = random.integer(1, 7);
        const int some = i % 10 == 0 ? random.integer(0, 400) : random.integer(0, 60);
        const int m = std::min(some, allowance_.most_rows);
        const Problem problem = make_problem(task, planes, n, m, random);
        ASSERT_TRUE(optimal_or_given_up(problem, difficulty_of(task, planes)))
            << name(task) << ", " << name(planes) << ", seed " << i << ", n = " << n
            << ", m = " << m;
      }
    }
  }
}

TEST_P(SolverContract, MixturesOfAllKindsOfPlanesAreOptimal) {
  // Problem 397870 is one of half a million in which rounding activates a row that pulls.
  for (int i = 397870; i > 377870; i -= stride()) {
    Random random(static_cast<std::uint64_t>(i) + 4500000);
    const int n = random.integer(1, 7);
    const Task task = i % 2 == 0 ? Task::slanted : tasks[static_cast<std::size_t>(i / 2 % 7)];
    Problem problem;
    make_task(problem, task, n, random);
    make_mixed_planes(problem, random.vector(n) * random.log_uniform(1, 1e6), random);
    ASSERT_TRUE(optimal_or_given_up(problem, Difficulty::weak))
        << name(task) << ", seed " << i << ", n = " << n;
  }
}

TEST_P(SolverContract, ProblemsOfAsManyRowsAsItCanTakeAreOptimal) {
  for (const Task task : tasks) {
    for (const Planes planes : plane_kinds) {
      for (int i = 0; i < 10; i += stride()) {  // 630 problems
        Random random(9000000 + static_cast<std::uint64_t>(i) * 100 +
                      static_cast<std::uint64_t>(task) * 10 + static_cast<std::uint64_t>(planes));
        const Problem problem =
            make_problem(task, planes, random.integer(1, 7), allowance_.most_rows, random);
        ASSERT_TRUE(optimal_or_given_up(problem, difficulty_of(task, planes)))
            << name(task) << ", " << name(planes) << ", seed " << i;
      }
    }
  }
}

TEST_P(SolverContract, TheMinimumIsTheOneFoundByEnumeration) {
  for (int i = 0; i < 4000; i += stride()) {
    Random random(static_cast<std::uint64_t>(i) + 5000000);
    const auto task = tasks[static_cast<std::size_t>(random.integer(0, 4))];
    const auto planes = plane_kinds[static_cast<std::size_t>(random.integer(0, 3))];
    const Problem problem =
        make_problem(task, planes, random.integer(1, 3), random.integer(0, 8), random);
    const auto expected = enumerate_minimum(problem.view());
    ASSERT_TRUE(expected.has_value()) << "seed " << i;
    ASSERT_TRUE(optimal_or_given_up(problem)) << "seed " << i;
    if (gave_up_) continue;
    // The accuracy of a solver is defined in task space.
    const Eigen::VectorXd off = u() - *expected;
    const auto length = [&](const Eigen::VectorXd& v) {
      return std::sqrt((problem.jacobian * v).squaredNorm() + problem.damping * v.squaredNorm());
    };
    EXPECT_LE(length(off), GetParam().accuracy * std::max(length(u()), problem.desired.norm()))
        << "seed " << i;
    if (is_exact()) {
      EXPECT_LT(off.norm(), 1e-9 * (1 + expected->norm())) << "seed " << i;
    }
  }
}

}  // namespace keepout::test
