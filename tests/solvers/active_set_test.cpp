// SPDX-License-Identifier: BSD-3-Clause
//
// Properties of the active-set solver alone: its budget, its range of numbers, its code for fixed
// and for variable sizes.
#include "keepout/solvers/active_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <vector>

#include "keepout/fixtures/random_problems.h"
#include "keepout/solvers/kkt.h"

namespace keepout::test {
namespace {

class ActiveSetTest : public testing::Test {
 protected:
  void SetUp() override { solver_.reserve(30, 4000); }

  SolveStatus solve(const Problem& problem) { return solver_.solve(problem.view(), solution_); }

  Eigen::VectorXd u() const {
    return Eigen::Map<const Eigen::VectorXd>(solution_.u.data(),
                                             static_cast<Eigen::Index>(solution_.u.size()));
  }

  ActiveSet solver_;
  Solution solution_;
};

TEST_F(ActiveSetTest, BeforeReserveEverythingIsOverCapacity) {
  ActiveSet fresh;
  Random random(1);
  Problem problem;
  make_task(problem, Task::identity, 3, random);
  make_planes(problem, Planes::scattered, Eigen::Vector3d::Zero(), 1, random);
  EXPECT_EQ(fresh.solve(problem.view(), solution_), SolveStatus::over_capacity);
}

TEST_F(ActiveSetTest, ManyVariablesAreSolvedLikeFew) {
  for (int i = 0; i < 300; ++i) {
    Random random(static_cast<std::uint64_t>(i));
    const int n = random.integer(8, 30);
    Problem problem;
    make_task(problem, tasks[static_cast<std::size_t>(random.integer(0, 6))], n, random);
    make_planes(problem, plane_kinds[static_cast<std::size_t>(random.integer(0, 8))],
                random.vector(n), 100, random);
    ASSERT_EQ(solve(problem), SolveStatus::optimal) << "seed " << i;
    EXPECT_LT(kkt_residual(problem.view(), solution_).worst(), 1e-9) << "seed " << i;
  }
}

TEST_F(ActiveSetTest, FixedAndRunTimeSizesAgree) {
  // 3, 6 and 7 variables have their own code; an idle variable added to 3 or 7 avoids it.
  for (int i = 0; i < 600; ++i) {
    Random random(static_cast<std::uint64_t>(i));
    const int n = std::array{3, 6, 7}[static_cast<std::size_t>(i % 3)];
    Problem problem;
    make_task(problem, Task::square, n, random);
    make_planes(problem, Planes::touching, random.vector(n), 40, random);
    ASSERT_EQ(solve(problem), SolveStatus::optimal);
    const Eigen::VectorXd expected = u();
    Problem wider = problem;
    wider.jacobian = StepProblem::Matrix::Identity(n + 1, n + 1);
    wider.jacobian.topLeftCorner(n, n) = problem.jacobian;
    wider.desired.conservativeResize(n + 1);
    wider.desired[n] = 0.5;
    wider.rows.setZero(40, n + 1);
    wider.rows.leftCols(n) = problem.rows;
    ASSERT_EQ(solve(wider), SolveStatus::optimal);
    EXPECT_LT((u().head(n) - expected).norm(), 1e-12 * (1 + expected.norm())) << "seed " << i;
    EXPECT_NEAR(u()[n], 0.5, 1e-14) << "seed " << i;
  }
}

TEST_F(ActiveSetTest, AnyNumberOfTaskRowsFitsTheReserve) {
  Random random(3);
  Problem problem;
  problem.jacobian = random.matrix(5000, 4);
  const Eigen::VectorXd exact = random.vector(4);
  problem.desired = problem.jacobian * exact;
  problem.rows.resize(0, 4);
  problem.bounds.resize(0);
  ASSERT_EQ(solve(problem), SolveStatus::optimal);
  EXPECT_LT((u() - exact).norm(), 1e-13);
}

TEST_F(ActiveSetTest, ANearlyFreeDirectionIsSolvedUntilRoundingDecidesIt) {
  for (const double weak : {1e-3, 1e-6, 1e-9, 1e-12, 1e-14, 1e-16, 0.0}) {
    Problem problem;
    problem.jacobian = Eigen::Vector3d(1, 1, weak).asDiagonal();
    problem.desired = Eigen::Vector3d(1, 1, weak);
    problem.rows = StepProblem::RowMatrix::Identity(3, 3);
    problem.bounds = Eigen::Vector3d(0, 2, 0);
    const SolveStatus status = solve(problem);
    if (weak >= 1e-12) {
      ASSERT_EQ(status, SolveStatus::optimal) << weak;
      EXPECT_LT((u() - Eigen::Vector3d(1, 2, 1)).norm(), 1e-14) << weak;
    } else {
      EXPECT_EQ(status, SolveStatus::ill_posed) << weak;
    }
  }
}

TEST_F(ActiveSetTest, NumbersWhoseSquaresLeaveTheRangeAreRefused) {
  Problem problem;
  problem.jacobian = StepProblem::Matrix::Identity(3, 3);
  problem.desired = Eigen::Vector3d(0, 0, -1);
  problem.rows = Eigen::RowVector3d(0, 0, 1);
  for (const double size : {1e-200, 1e-100, 1e100, 1e200}) {
    problem.rows = Eigen::RowVector3d(0, 0, size);
    problem.bounds = Eigen::VectorXd::Zero(1);
    EXPECT_EQ(solve(problem), SolveStatus::invalid_input) << size;
  }
  for (const double size : {1e-60, 1e60}) {
    problem.rows = Eigen::RowVector3d(0, 0, size);
    problem.bounds = Eigen::VectorXd::Constant(1, size);
    ASSERT_EQ(solve(problem), SolveStatus::optimal) << size;
    EXPECT_NEAR(u()[2], 1, 1e-15) << size;
  }
}

TEST_F(ActiveSetTest, AnAnswerOutOfRangeIsWithheld) {
  // The rows cannot be checked at a point with an infinite square.
  Problem problem;
  problem.jacobian = 1e-60 * StepProblem::Matrix::Identity(3, 3);
  problem.rows = Eigen::RowVector3d(0, 0, 1);
  problem.bounds = Eigen::VectorXd::Zero(1);
  for (const double size : {1e60, -1e60}) {
    problem.desired = Eigen::Vector3d(0, size, size);
    EXPECT_EQ(solve(problem), SolveStatus::iteration_limit) << size;
  }
}

TEST_F(ActiveSetTest, TheLowestOfEqualRowsIsTheActiveOne) {
  Problem problem;
  problem.jacobian = StepProblem::Matrix::Identity(3, 3);
  problem.desired = Eigen::Vector3d(0, 0, -1);
  problem.rows = StepProblem::RowMatrix::Zero(4, 3);
  problem.rows.col(2).setOnes();
  problem.bounds = Eigen::Vector4d(-0.5, 0, 0, 0);
  ASSERT_EQ(solve(problem), SolveStatus::optimal);
  ASSERT_EQ(solution_.active.size(), 1U);
  EXPECT_EQ(solution_.active[0], 1U);
}

TEST_F(ActiveSetTest, RowsThatStopPushingOnTheWayAreLetGo) {
  // Row 0, y >= 1, is violated most at the start (0, -10) and enters first. The task moves y more
  // easily than x. So row 1, 0.6 x + 0.8 y >= 2, alone lifts y beyond 1. Its step is t (J^T J)^-1
  // (0.6, 0.8) = t (0.006, 0.8) with t = 10 / (0.6 * 0.006 + 0.8 * 0.8).
  Problem problem;
  problem.jacobian = Eigen::Vector2d(10, 1).asDiagonal();
  problem.desired = Eigen::Vector2d(0, -10);
  problem.rows.resize(2, 2);
  problem.rows << 0, 1, 0.6, 0.8;
  problem.bounds = Eigen::Vector2d(1, 2);
  const double t = 10 / 0.6436;
  ASSERT_EQ(solve(problem), SolveStatus::optimal);
  EXPECT_LT((u() - Eigen::Vector2d(0.006 * t, 0.8 * t - 10)).norm(), 1e-14);
  ASSERT_EQ(solution_.active.size(), 1U);
  EXPECT_EQ(solution_.active[0], 1U);
  EXPECT_NEAR(solution_.multipliers[0], 2 * t, 1e-12);
}

TEST_F(ActiveSetTest, ARowThatHoldsWithoutPushingIsNotListed) {
  // Like the problem above, but without rounding. Row 1 moves the point by t (0.25, 2) with t =
  // 5.5. This lifts y from -10 to exactly 1, the bound of row 0. The multiplier of row 0 falls from
  // 22 to exactly 0.
  Problem problem;
  problem.jacobian = Eigen::Vector2d(2, 1).asDiagonal();
  problem.desired = Eigen::Vector2d(0, -10);
  problem.rows.resize(2, 2);
  problem.rows << 0, 1, 1, 2;
  problem.bounds = Eigen::Vector2d(1, 3.375);
  ASSERT_EQ(solve(problem), SolveStatus::optimal);
  EXPECT_LT((u() - Eigen::Vector2d(1.375, 1)).norm(), 1e-14);
  ASSERT_EQ(solution_.active.size(), 1U);
  EXPECT_EQ(solution_.active[0], 1U);
  EXPECT_NEAR(solution_.multipliers[0], 11, 1e-13);
}

TEST_F(ActiveSetTest, BoundsOfVariablesGiveTheBitsOfTheirRows) {
  int solved = 0;
  int contradictory = 0;
  int at_bounds = 0;
  ActiveSet by_rows;
  by_rows.reserve(30, 4000);
  for (int i = 0; i < 6000; ++i) {
    Random random(static_cast<std::uint64_t>(i));
    const int n = random.integer(2, 8);
    Problem problem;
    make_task(problem, tasks[static_cast<std::size_t>(random.integer(0, 6))], n, random);
    const Eigen::VectorXd inside = random.vector(n);
    make_planes(problem, plane_kinds[static_cast<std::size_t>(random.integer(0, 8))], inside,
                random.integer(0, 10), random);
    if (i % 5 == 0 && problem.rows.rows() > 2) make_infeasible(problem, 1e-3, random);
    // Bounds of most variables: apart, equal, in contradiction, or through the feasible point.
    std::vector<std::uint8_t> box;
    std::vector<double> bounds;
    for (int k = 0; k < n; ++k) {
      const double width = std::array{1.0, 0.1, 0.0, -1e-9}[static_cast<std::size_t>(
          i % 7 == 0 ? random.integer(2, 3) : random.integer(0, 2))];
      const double low = inside[k] - (random.integer(0, 1) == 0 ? 0.0 : width);
      for (const int side : {0, 1}) {
        if (random.integer(0, 7) == 0) continue;
        box.push_back(static_cast<std::uint8_t>(2 * k + side));
        bounds.push_back(side == 0 ? low : -(low + width));
      }
    }
    const Eigen::Index first = problem.rows.rows();
    const auto count = static_cast<Eigen::Index>(box.size());
    StepProblem::RowMatrix rows = StepProblem::RowMatrix::Zero(first + count, n);
    if (first > 0) rows.topRows(first) = problem.rows;
    problem.rows = rows;
    problem.bounds.conservativeResize(first + count);
    for (Eigen::Index b = 0; b < count; ++b) {
      const int number = box[static_cast<std::size_t>(b)];
      problem.rows(first + b, number / 2) = number % 2 == 0 ? 1 : -1;
      problem.bounds[first + b] = bounds[static_cast<std::size_t>(b)];
    }
    StepProblem with_box = problem.view();
    with_box.box = box;
    Solution expected;
    const SolveStatus status = by_rows.solve(problem.view(), expected);
    ASSERT_EQ(solver_.solve(with_box, solution_), status) << "seed " << i;
    EXPECT_EQ(solution_.iterations, expected.iterations) << "seed " << i;
    contradictory += status == SolveStatus::infeasible;
    if (status != SolveStatus::optimal) continue;
    ++solved;
    EXPECT_TRUE(std::ranges::equal(solution_.u, expected.u)) << "seed " << i;
    EXPECT_TRUE(std::ranges::equal(solution_.active, expected.active)) << "seed " << i;
    EXPECT_TRUE(std::ranges::equal(solution_.multipliers, expected.multipliers)) << "seed " << i;
    EXPECT_LT(kkt_residual(problem.view(), solution_).worst(), 1e-9) << "seed " << i;
    at_bounds += std::ranges::any_of(solution_.active, [&](std::uint32_t row) {
      return static_cast<Eigen::Index>(row) >= first;
    });
  }
  EXPECT_GT(solved, 3000);
  EXPECT_GT(contradictory, 300);
  EXPECT_GT(at_bounds, 1500);
}

TEST_F(ActiveSetTest, ABoxThatIsNoneIsRefused) {
  Problem problem;
  problem.jacobian = StepProblem::Matrix::Identity(2, 2);
  problem.desired = Eigen::Vector2d(1, 1);
  problem.rows = StepProblem::RowMatrix::Identity(2, 2);
  problem.bounds = Eigen::Vector2d(0, 2);
  StepProblem with_box = problem.view();
  const std::array<std::uint8_t, 3> box{0, 2, 4};
  with_box.box = {box.data(), 2};
  ASSERT_EQ(solver_.solve(with_box, solution_), SolveStatus::optimal);
  EXPECT_EQ(u(), Eigen::Vector2d(1, 2));
  with_box.box = {box.data(), 3};  // more than rows
  EXPECT_EQ(solver_.solve(with_box, solution_), SolveStatus::invalid_input);
  with_box.box = {box.data() + 2, 1};  // a variable that does not exist
  EXPECT_EQ(solver_.solve(with_box, solution_), SolveStatus::invalid_input);
  with_box.box = {box.data(), 2};
  for (const double bound : {std::numeric_limits<double>::quiet_NaN(), 1e100}) {
    problem.bounds[1] = bound;
    EXPECT_EQ(solver_.solve(with_box, solution_), SolveStatus::invalid_input) << bound;
  }
}

TEST_F(ActiveSetTest, ATaskThatChangesIsFactoredAnew) {
  // A, then B, then A again: each as by a solver that has solved nothing before.
  for (int i = 0; i < 600; ++i) {
    Random random(static_cast<std::uint64_t>(i));
    const int n = std::array{2, 3, 6, 7, 8}[static_cast<std::size_t>(i % 5)];
    std::array<Problem, 2> problems;
    make_task(problems[0], tasks[static_cast<std::size_t>(random.integer(0, 6))], n, random);
    make_planes(problems[0], Planes::touching, random.vector(n), 8, random);
    if (problems[0].jacobian.rows() == 0) continue;  // nothing to change
    Problem& other = problems[1] = problems[0];
    const int column = random.integer(0, n - 1);
    switch (i / 5 % 5) {
      case 0:
        other.damping += 1e-3;
        break;
      case 1:
        other.jacobian(0, column) *= 1 + 0x1p-52;
        other.jacobian(0, column) += 0x1p-52;
        break;
      case 2:
        other.desired[0] += 0x1p-40;
        break;
      case 3:  // another number of task rows
        other.jacobian.conservativeResize(other.jacobian.rows() + 1, n);
        other.jacobian.row(other.jacobian.rows() - 1).setOnes();
        other.desired.conservativeResize(other.jacobian.rows());
        other.desired[other.desired.size() - 1] = 1;
        break;
      default:  // another number of variables
        make_task(other, Task::square, n + 1, random);
        make_planes(other, Planes::touching, random.vector(n + 1), 8, random);
    }
    for (const std::size_t which : {0U, 1U, 0U}) {
      ActiveSet fresh;
      fresh.reserve(9, 8);
      Solution expected;
      const SolveStatus status = fresh.solve(problems[which].view(), expected);
      ASSERT_EQ(solve(problems[which]), status) << "seed " << i;
      EXPECT_EQ(solution_.iterations, expected.iterations) << "seed " << i;
      EXPECT_TRUE(std::ranges::equal(solution_.u, expected.u)) << "seed " << i;
    }
  }
}

TEST_F(ActiveSetTest, ACavityOfThousandsOfNearlyEqualPlanesStaysWithinTheBudget) {
  // Tangent planes of a sphere, with a push from inside. Neighbors differ by milliradians. At the
  // optimum, three planes are active and hundreds are almost active.
  for (int i = 0; i < 50; ++i) {
    Random random(static_cast<std::uint64_t>(i));
    Problem problem;
    make_task(problem, Task::identity, 3, random);
    problem.desired *= 1 + random.uniform(0, 100);
    problem.rows.resize(4000, 3);
    problem.bounds = Eigen::VectorXd::Constant(4000, -1);
    for (Eigen::Index row = 0; row < 4000; ++row) {
      const double height = 1 - 2 * (static_cast<double>(row) + 0.5) / 4000;
      const double angle = static_cast<double>(row) * std::numbers::phi * 2 * std::numbers::pi;
      const double radius = std::sqrt(1 - height * height);
      problem.rows.row(row) << -radius * std::cos(angle), -radius * std::sin(angle), -height;
    }
    ASSERT_EQ(solve(problem), SolveStatus::optimal) << "seed " << i;
    EXPECT_LT(kkt_residual(problem.view(), solution_).worst(), 1e-12) << "seed " << i;
    EXPECT_LT(solution_.iterations, 40) << "seed " << i;
  }
}

}  // namespace
}  // namespace keepout::test
