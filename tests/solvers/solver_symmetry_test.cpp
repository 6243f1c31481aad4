// SPDX-License-Identifier: BSD-3-Clause
// What must not change the answer: units, lengths and order of rows, what was solved before.

#include "solvers/solver_contract.h"

namespace keepout::test {
namespace {

using SolverSymmetry = SolverContract;

INSTANTIATE_TEST_SUITE_P(Solvers, SolverSymmetry, testing::ValuesIn(solver_backends()),
                         solver_name);

TEST_P(SolverSymmetry, AnotherUnitOfLengthGivesTheSameMotionInThatUnit) {
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

TEST_P(SolverSymmetry, TheLengthOfARowDoesNotMatter) {
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

TEST_P(SolverSymmetry, TheOrderOfTheRowsDoesNotMatter) {
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

TEST_P(SolverSymmetry, EarlierSolvesLeaveNoTrace) {
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
    EXPECT_EQ(u(), first);  // to the last bit
    EXPECT_TRUE(std::ranges::equal(solution_.multipliers, multipliers));
    EXPECT_TRUE(std::ranges::equal(solution_.active, active));
  }
}

TEST_P(SolverSymmetry, ActiveRowsAreSortedAndPush) {
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

}  // namespace
}  // namespace keepout::test
