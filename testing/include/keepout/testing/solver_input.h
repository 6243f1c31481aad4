// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Input that solvers must reject.

#include "keepout/testing/solver_trials.h"

namespace keepout::test {

inline Problem valid_problem() {
  Random random(42);
  Problem problem;
  make_task(problem, Task::square, 3, random);
  make_planes(problem, Planes::scattered, Eigen::Vector3d::Zero(), 5, random);
  return problem;
}

TEST_P(SolverContract, AnyNumberThatIsNotFiniteIsRefused) {
  for (const double bad : {nan, infinity, -infinity}) {
    for (int at = 0; at < 9 + 3 + 15 + 5 + 1; ++at) {
      Problem problem = valid_problem();
      if (at < 9) {
        problem.jacobian.data()[at] = bad;
      } else if (at < 12) {
        problem.desired[at - 9] = bad;
      } else if (at < 27) {
        problem.rows.data()[at - 12] = bad;
      } else if (at < 32) {
        problem.bounds[at - 27] = bad;
      } else {
        problem.damping = bad;
      }
      EXPECT_EQ(solve(problem), SolveStatus::invalid_input) << bad << " at " << at;
      EXPECT_TRUE(solution_.u.empty()) << bad << " at " << at;
    }
  }
}

TEST_P(SolverContract, NotFiniteBoundsOfZeroRowsAreRefused) {
  for (const double bad : {nan, infinity, -infinity}) {
    Problem problem = valid_problem();
    problem.rows.row(2).setZero();
    problem.bounds[2] = bad;
    EXPECT_EQ(solve(problem), SolveStatus::invalid_input) << bad;
  }
}

TEST_P(SolverContract, NegativeDampingIsRefused) {
  Problem problem = valid_problem();
  problem.damping = -1e-9;
  EXPECT_EQ(solve(problem), SolveStatus::invalid_input);
}

TEST_P(SolverContract, ShapesThatDisagreeAreRefused) {
  Problem problem = valid_problem();
  problem.desired.conservativeResize(2);
  EXPECT_EQ(solve(problem), SolveStatus::invalid_input);
  problem = valid_problem();
  problem.bounds.conservativeResize(4);
  EXPECT_EQ(solve(problem), SolveStatus::invalid_input);
  problem = valid_problem();
  problem.rows = StepProblem::RowMatrix::Ones(5, 2);
  EXPECT_EQ(solve(problem), SolveStatus::invalid_input);
  problem = {};
  EXPECT_EQ(solve(problem), SolveStatus::invalid_input) << "no variables";
}

TEST_P(SolverContract, MoreThanReservedIsRefusedAndNotTruncated) {
  solver_->reserve(3, 5);
  EXPECT_TRUE(optimal(valid_problem()));
  solver_->reserve(3, 4);
  EXPECT_EQ(solve(valid_problem()), SolveStatus::over_capacity);
  solver_->reserve(2, 5);
  EXPECT_EQ(solve(valid_problem()), SolveStatus::over_capacity);
  EXPECT_TRUE(solution_.u.empty());
}

TEST_P(SolverContract, ATaskThatLeavesADirectionFreeIsIllPosed) {
  for (int i = 0; i < 500; i += stride()) {
    Random random(static_cast<std::uint64_t>(i) + 8000000);
    const int n = random.integer(1, 7);
    const int rank = random.integer(0, n - 1);
    const int k = random.integer(rank, n + 10);
    Problem problem;
    problem.jacobian = random.matrix(k, rank) * random.matrix(rank, n);
    problem.desired = random.vector(k);
    make_planes(problem, Planes::scattered, random.vector(n), 10, random);
    EXPECT_EQ(solve(problem), SolveStatus::ill_posed) << "seed " << i;
    problem.damping = 1e-3;
    EXPECT_TRUE(optimal_or_given_up(problem)) << "seed " << i;
  }
}

}  // namespace keepout::test
