// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/solvers/recording_solver.h"

#include <gtest/gtest.h>

#include "keepout/solvers/active_set.h"
#include "solvers/solver_contract.h"

namespace keepout::test {
namespace {

TEST(RecordingSolver, AnswersAsTheSolverBehindItAndKeepsTheProblem) {
  std::vector<RecordedProblem> record;
  RecordingSolver recording(std::make_unique<ActiveSet>(), record);
  recording.reserve(3, 20);
  ActiveSet exact;
  exact.reserve(3, 20);
  for (int i = 0; i < 20; ++i) {
    Random random(static_cast<std::uint64_t>(i));
    Problem problem = make_problem(Task::wide_damped, Planes::touching, 3, i, random);
    Solution through, direct, again;
    ASSERT_EQ(recording.solve(problem.view(), through), exact.solve(problem.view(), direct));
    const Eigen::VectorXd expected = vector(direct.u);
    EXPECT_EQ(vector(through.u), expected);
    problem.rows.setZero();  // the record is a copy
    ASSERT_EQ(record.size(), static_cast<std::size_t>(i) + 1);
    ASSERT_EQ(exact.solve(record.back().view(), again), SolveStatus::optimal);
    EXPECT_EQ(vector(again.u), expected);
  }
}

}  // namespace
}  // namespace keepout::test
