// SPDX-License-Identifier: BSD-3-Clause
// What the contract of all solvers does not say: what NLopt claims, and that it is not believed.
#include "keepout/solvers/nlopt_solver.h"

#include "keepout/solvers/active_set.h"
#include "solvers/solver_contract.h"

namespace keepout::test {
namespace {

/// x >= 1 as seen from 0, and a push into it.
Problem wall() {
  StepProblem::RowMatrix rows(1, 2);
  rows << 1, 0;
  return point_problem(Eigen::Vector2d(-3, 2), rows, Eigen::VectorXd::Constant(1, 1));
}

TEST(NloptSolver, ReportsWhatNloptClaimsAndWhatWasFound) {
  NloptSolver solver(NloptMethod::slsqp);
  solver.reserve(2, 2);
  Solution solution;
  const Problem problem = wall();
  ASSERT_EQ(solver.solve(problem.view(), solution), SolveStatus::optimal);
  EXPECT_NE(solver.last_report().claim, "not asked");
  EXPECT_EQ(solver.last_report().finding, NloptFinding::optimal);
  EXPECT_GT(solution.iterations, 0);
}

TEST(NloptSolver, DoesNotAskNloptAboutWhatItRefuses) {
  NloptSolver solver(NloptMethod::slsqp);
  solver.reserve(2, 2);
  Solution solution;
  Problem problem = wall();
  problem.desired[0] = nan;
  ASSERT_EQ(solver.solve(problem.view(), solution), SolveStatus::invalid_input);
  EXPECT_EQ(solver.last_report().claim, "not asked");
  EXPECT_EQ(solver.last_report().finding, NloptFinding::refused);
  EXPECT_EQ(solution.iterations, 0);
}

TEST(NloptSolver, ProvesAContradictionThatNloptDoesNotSee) {
  for (const NloptMethod method : {NloptMethod::slsqp, NloptMethod::cobyla, NloptMethod::mma}) {
    NloptSolver solver(method);
    solver.reserve(2, 2);
    StepProblem::RowMatrix rows(2, 2);
    rows << 1, 0, -1, 0;
    const Problem problem =
        point_problem(Eigen::Vector2d(1, 1), rows, Eigen::Vector2d(1, 0));  // x >= 1, x <= 0
    Solution solution;
    EXPECT_EQ(solver.solve(problem.view(), solution), SolveStatus::infeasible);
    EXPECT_EQ(solver.last_report().finding, NloptFinding::infeasible);
    EXPECT_TRUE(solution.u.empty());
  }
}

TEST(NloptSolver, TheFirstOfEqualRowsIsTheActiveOneAndTheTightestOfParallelOnes) {
  NloptSolver solver(NloptMethod::slsqp);
  solver.reserve(2, 8);
  StepProblem::RowMatrix rows(5, 2);
  rows << 1, 0, 2, 0, 0, 1, 3, 0, 1, 0;
  Eigen::VectorXd bounds(5);
  bounds << 0, 2, -9, 3, 1;  // x >= 0, and three times x >= 1
  const Problem problem = point_problem(Eigen::Vector2d(-3, 2), rows, bounds);
  Solution solution;
  ASSERT_EQ(solver.solve(problem.view(), solution), SolveStatus::optimal);
  ASSERT_EQ(solution.active.size(), 1U);
  EXPECT_EQ(solution.active[0], 1U);
  EXPECT_NEAR(solution.multipliers[0], 4, 1e-9);
}

TEST(NloptSolver, AgreesWithActiveSetInUnitsOfAnySize) {
  NloptSolver solver(NloptMethod::slsqp);
  solver.reserve(7, 60);
  ActiveSet exact;
  exact.reserve(7, 60);
  for (int i = 0; i < 500; ++i) {
    Random random(static_cast<std::uint64_t>(i) + 11000000);
    Problem problem =
        make_problem(Task::square, Planes::touching, random.integer(1, 7), 40, random);
    const double unit = random.log_uniform(1e-6, 1e6);
    const double joints = random.log_uniform(1e-3, 1e3);  // unit of the variables
    problem.desired *= unit;
    problem.bounds *= unit;
    problem.jacobian *= joints;
    problem.rows *= joints;
    Solution got, expected;
    ASSERT_EQ(solver.solve(problem.view(), got), SolveStatus::optimal) << "seed " << i;
    ASSERT_EQ(exact.solve(problem.view(), expected), SolveStatus::optimal) << "seed " << i;
    const Eigen::VectorXd best = vector(expected.u);
    EXPECT_LE((vector(got.u) - best).norm(), 1e-9 * best.norm()) << "seed " << i;
  }
}

TEST(NloptSolver, EveryFindingHasANameOfItsOwn) {
  std::vector<std::string_view> names;
  for (int i = 0; i <= static_cast<int>(NloptFinding::infeasible); ++i) {
    names.push_back(name(static_cast<NloptFinding>(i)));
  }
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::adjacent_find(names), names.end());
  EXPECT_EQ(NloptSolver::library().substr(0, 6), "NLopt ");
}

}  // namespace
}  // namespace keepout::test
