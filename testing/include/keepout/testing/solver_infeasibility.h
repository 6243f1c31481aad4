// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Solvers recognize problems without a solution, and never report a solvable problem as infeasible.

#include "keepout/testing/solver_trials.h"

namespace keepout::test {

TEST_P(SolverContract, ContradictionsAreRecognised) {
  // Some of the rows, made unit rows, add up to 0 u >= margin with weights of order 1. Margins go
  // down to 1e-9, far above rounding. For a task of condition 1e6, they go down to 1e-3 only. Its
  // steps are 1e6 times longer than the distances between planes, and round to 1e-10.
  for (const Task task : tasks) {
    for (const Planes planes : {Planes::scattered, Planes::touching, Planes::uneven}) {
      for (int i = 0; i < 500; i += stride()) {
        Random random(static_cast<std::uint64_t>(i) * 100 + static_cast<std::uint64_t>(task) * 10 +
                      static_cast<std::uint64_t>(planes));
        const int n = random.integer(1, 7);
        Problem problem;
        make_task(problem, task, n, random);
        make_planes(problem, planes, random.vector(n), random.integer(2, 60), random);
        const bool weak = task == Task::slanted || task == Task::uneven_columns;
        make_infeasible(problem, random.log_uniform(weak ? 1e-3 : 1e-9, 1), random);
        ASSERT_TRUE(infeasible_or_given_up(problem, difficulty_of(task, planes)))
            << name(task) << ", " << name(planes) << ", seed " << i << ", n = " << n;
      }
    }
  }
}

TEST_P(SolverContract, ContradictionsOnlyFarAwayAreNeverSolvedWrongly) {
  // The weights span twelve decades. The planes are parallel up to the last digits, and meet where
  // the margin is below rounding. A solver may give up there, but must not claim an optimum that
  // violates a row.
  int recognised = 0, posed = 0;
  for (int i = 0; i < 2000; i += stride()) {
    Random random(static_cast<std::uint64_t>(i) + 7500000);
    const int n = random.integer(1, 7);
    Problem problem = make_problem(Task::identity, Planes::scattered, n, 20, random);
    for (Eigen::Index row = 0; row < 20; ++row) {
      const double weight = random.log_uniform(1e-6, 1e6);
      problem.rows.row(row) *= weight;
      problem.bounds[row] *= weight;
    }
    make_infeasible(problem, random.log_uniform(1e-9, 1), random, Weights::as_they_are);
    const SolveStatus status = solve(problem);
    ++posed;
    recognised += status == SolveStatus::infeasible ? 1 : 0;
    if (status == SolveStatus::optimal) {
      ASSERT_TRUE(optimal(problem)) << "seed " << i;
    } else {
      ASSERT_TRUE(status == SolveStatus::infeasible || status == SolveStatus::iteration_limit)
          << "seed " << i << ": " << name(status);
    }
  }
  if (!allowance_.proves_infeasible) return;
  EXPECT_GT(recognised, (is_exact() ? 0.95 : 0.8) * posed);
}

TEST_P(SolverContract, ASlabIsOpenEmptyOrUndecidedByItsWidthAgainstRounding) {
  // b <= a u <= b + width. Slabs wider than rounding are solvable; widths below minus rounding
  // are infeasible. In between, either answer is right, but "optimal" must satisfy the rows to the
  // bound, which optimal() checks.
  for (int i = 0; i < 2000; i += stride()) {
    Random random(static_cast<std::uint64_t>(i) + 7000000);
    const int n = random.integer(1, 7);
    Problem problem;
    make_task(problem, tasks[static_cast<std::size_t>(random.integer(0, 3))], n, random);
    const Eigen::VectorXd a = random.direction(n);
    const double b = random.uniform(-1, 1);
    const double size = random.log_uniform(1e-16, 1);
    for (const double width : {size, 0.0, -size}) {
      problem.rows.resize(2, n);
      problem.rows << a.transpose(), -a.transpose();
      problem.bounds = Eigen::Vector2d(b, -(b + width));
      const SolveStatus status = solve(problem);
      if (width >= 0) {
        ASSERT_TRUE(optimal_or_given_up(problem, Difficulty::tangled))
            << "seed " << i << ", width " << width;
      } else if (width < -1e-9) {
        ASSERT_TRUE(infeasible_or_given_up(problem, Difficulty::tangled))
            << "seed " << i << ", width " << width;
      } else if (status == SolveStatus::optimal) {
        ASSERT_TRUE(optimal(problem)) << "seed " << i << ", width " << width;
      } else {
        ASSERT_TRUE(status == SolveStatus::infeasible || status == SolveStatus::iteration_limit);
      }
    }
  }
}

TEST_P(SolverContract, PlanesThatMeetAtATinyAngleStillHaveTheirEdge) {
  // y >= 0 and -y + angle x >= h meet in a wedge with its apex at x = h / angle. The target is
  // behind the apex, so the answer is the apex, however slim the wedge.
  for (const double angle : {1e-1, 1e-4, 1e-8, 1e-10}) {
    for (const double h : {0.0, 1e-6, 1e-3}) {
      StepProblem::RowMatrix rows(2, 2);
      rows << 0, 1, angle, -1;
      const Problem problem = point_problem(Eigen::Vector2d(-1, 0.5), rows, Eigen::Vector2d(0, h));
      ASSERT_TRUE(optimal_or_given_up(problem, Difficulty::weak)) << angle << ", " << h;
      if (gave_up_) continue;
      // A row holds to 1e-13 of the motion. Along the wedge, the error is 1 / angle times larger.
      EXPECT_NEAR(u()[0], h / angle, digits(2e-13 / angle) * (1 + h / angle)) << angle << ", " << h;
    }
  }
}

TEST_P(SolverContract, ARowOfZerosCountsOnlyByItsBound) {
  for (const double bound : {-1.0, 0.0, 1e-300, 1.0}) {
    StepProblem::RowMatrix rows(2, 2);
    rows << 0, 0, 0, 1;
    const Problem problem = point_problem(Eigen::Vector2d(1, -1), rows, Eigen::Vector2d(bound, 0));
    if (bound > 0) {
      EXPECT_EQ(solve(problem), SolveStatus::infeasible);
    } else {
      ASSERT_TRUE(optimal(problem));
      EXPECT_LT((u() - Eigen::Vector2d(1, 0)).norm(), digits(1e-15));
    }
  }
}

// The answer must not depend on units, on lengths and order of rows, or on earlier problems.

TEST_P(SolverContract, AnotherUnitOfLengthGivesTheSameMotionInThatUnit) {
  for (int i = 0; i < 500; i += stride()) {
    Random random(static_cast<std::uint64_t>(i) + 1000000);
    const auto planes = plane_kinds[static_cast<std::size_t>(random.integer(0, 8))];
    const Problem problem = make_problem(Task::identity, planes, random.integer(1, 7), 40, random);
    const Difficulty difficulty = difficulty_of(Task::identity, planes);
    ASSERT_TRUE(optimal_or_given_up(problem, difficulty));
    if (gave_up_) continue;
    const Eigen::VectorXd expected = u();
    for (const double unit : {1e-6, 1e6}) {
      Problem scaled = problem;
      scaled.desired *= unit;
      scaled.bounds *= unit;
      ASSERT_TRUE(optimal_or_given_up(scaled, difficulty))
          << name(planes) << ", seed " << i << ", unit " << unit;
      if (gave_up_) continue;
      EXPECT_LT((u() - unit * expected).norm(), digits(1e-10) * unit * (1 + expected.norm()))
          << name(planes) << ", seed " << i << ", unit " << unit;
    }
  }
}

TEST_P(SolverContract, TheLengthOfARowDoesNotMatter) {
  for (int i = 0; i < 500; i += stride()) {
    Random random(static_cast<std::uint64_t>(i) + 2000000);
    const Problem problem =
        make_problem(Task::square, Planes::scattered, random.integer(1, 7), 40, random);
    ASSERT_TRUE(optimal_or_given_up(problem));
    if (gave_up_) continue;
    const Eigen::VectorXd expected = u();
    Problem scaled = problem;
    for (Eigen::Index row = 0; row < 40; ++row) {
      const double scale = random.log_uniform(1e-6, 1e6);
      scaled.rows.row(row) *= scale;
      scaled.bounds[row] *= scale;
    }
    ASSERT_TRUE(optimal_or_given_up(scaled)) << "seed " << i;
    if (gave_up_) continue;
    EXPECT_LT((u() - expected).norm(), digits(1e-12) * (1 + expected.norm())) << "seed " << i;
  }
}

TEST_P(SolverContract, TheOrderOfTheRowsDoesNotMatter) {
  for (int i = 0; i < 1000; i += stride()) {
    Random random(static_cast<std::uint64_t>(i) + 3000000);
    const auto planes = plane_kinds[static_cast<std::size_t>(random.integer(0, 4))];
    const Problem problem = make_problem(Task::square, planes, random.integer(1, 7), 40, random);
    ASSERT_TRUE(optimal_or_given_up(problem));
    if (gave_up_) continue;
    const Eigen::VectorXd expected = u();
    Problem shuffled = problem;
    for (int row = 39; row > 0; --row) {
      const int other = random.integer(0, row);
      shuffled.rows.row(row).swap(shuffled.rows.row(other));
      std::swap(shuffled.bounds[row], shuffled.bounds[other]);
    }
    ASSERT_TRUE(optimal_or_given_up(shuffled)) << "seed " << i;
    if (gave_up_) continue;
    EXPECT_LT((u() - expected).norm(), digits(1e-12) * (1 + expected.norm())) << "seed " << i;
  }
}

TEST_P(SolverContract, EarlierSolvesLeaveNoTrace) {
  Random random(4000000);
  for (int i = 0; i < 200; i += stride()) {
    const Problem problem =
        make_problem(Task::tall, Planes::touching, random.integer(1, 7), 50, random);
    ASSERT_TRUE(optimal_or_given_up(problem));
    if (gave_up_) continue;
    const Eigen::VectorXd first = u();
    const std::vector<double> multipliers(solution_.multipliers.begin(),
                                          solution_.multipliers.end());
    const std::vector<std::uint32_t> active(solution_.active.begin(), solution_.active.end());
    const Problem other =
        make_problem(Task::slanted, Planes::vertex, random.integer(1, 7), 100, random);
    ASSERT_TRUE(optimal_or_given_up(other, Difficulty::weak));
    ASSERT_TRUE(optimal(problem));
    EXPECT_EQ(u(), first);  // bitwise identical
    EXPECT_TRUE(std::ranges::equal(solution_.multipliers, multipliers));
    EXPECT_TRUE(std::ranges::equal(solution_.active, active));
  }
}

TEST_P(SolverContract, ActiveRowsAreSortedAndPush) {
  for (int i = 0; i < 1000; i += stride()) {
    Random random(static_cast<std::uint64_t>(i) + 6000000);
    Problem problem = make_problem(Task::identity, Planes::lattice, 5, 60, random);
    problem.desired = problem.desired.array().round();
    ASSERT_TRUE(optimal_or_given_up(problem));
    if (gave_up_) continue;
    ASSERT_EQ(solution_.active.size(), solution_.multipliers.size());
    EXPECT_TRUE(std::ranges::is_sorted(solution_.active, std::less_equal{}));
    EXPECT_TRUE(std::ranges::all_of(solution_.multipliers, [](double x) { return x > 0; }));
  }
}

}  // namespace keepout::test
