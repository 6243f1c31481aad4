// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// The judge of NLopt's answers, given answers that are wrong.
#include "answer_check.h"

#include "contradiction.h"
#include "keepout/solvers/active_set.h"
#include "solvers/solver_contract.h"
#include "trials.h"

namespace keepout::test {
namespace {

constexpr double accuracy = 1e-6;

/// A problem, and its optimum.
struct Posed {
  Posed(Task kind, Planes planes, std::uint64_t seed) : random(seed) {
    const int n = random.integer(1, 7);
    problem = make_problem(kind, planes, n, random.integer(0, 60), random);
    ActiveSet exact;
    exact.reserve(n, 60);
    Solution solution;
    EXPECT_EQ(exact.solve(problem.view(), solution), SolveStatus::optimal);
    best = vector(solution.u);
  }

  nlopt::CheckedAnswer check(const Eigen::VectorXd& u) const {
    const StepProblem view = problem.view();
    nlopt::Task task;
    task.reserve(static_cast<int>(best.size()));
    EXPECT_TRUE(task.read(view));
    return nlopt::check_answer(u, view, task, nlopt::NearestPoint(view, task), accuracy);
  }

  /// In task space.
  double length(const Eigen::VectorXd& v) const {
    return std::sqrt((problem.jacobian * v).squaredNorm() + problem.damping * v.squaredNorm());
  }

  Random random;
  Problem problem;
  Eigen::VectorXd best;
};

TEST(AnswerCheck, AcceptsTheOptimum) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    const Posed posed(Task::square, Planes::touching, seed);
    const nlopt::CheckedAnswer answer = posed.check(posed.best);
    ASSERT_EQ(answer.finding, NloptFinding::optimal) << "seed " << seed;
    EXPECT_LE((answer.u - posed.best).norm(), 1e-9 * posed.best.norm()) << "seed " << seed;
  }
}

TEST(AnswerCheck, AcceptsNothingThatIsFartherFromTheOptimumThanItSays) {
  // From last digits to wild guesses, in any direction; of every kind of problem.
  int accepted = 0, rejected = 0;
  for (std::uint64_t seed = 0; seed < trials(6000u); ++seed) {
    Posed posed(tasks[seed % tasks.size()], plane_kinds[seed / tasks.size() % plane_kinds.size()],
                seed);
    const double far = posed.random.log_uniform(1e-12, 10) * (1e-3 + posed.best.norm());
    const Eigen::VectorXd lie = posed.best + far * posed.random.direction(posed.best.size());
    const nlopt::CheckedAnswer answer = posed.check(lie);
    if (answer.finding != NloptFinding::optimal) {
      ++rejected;
      continue;
    }
    ++accepted;
    const double reach = std::max(posed.length(posed.best), posed.problem.desired.norm());
    EXPECT_LE(posed.length(answer.u - posed.best), 1.01 * accuracy * reach) << "seed " << seed;
    const Solution solution{.u = {answer.u.data(), static_cast<std::size_t>(answer.u.size())},
                            .multipliers = answer.multipliers,
                            .active = answer.active};
    EXPECT_LE(kkt_residual(posed.problem.view(), solution).worst(), accuracy) << "seed " << seed;
  }
  EXPECT_GT(accepted, trials(1200));
  EXPECT_GT(rejected, trials(1200));
}

TEST(AnswerCheck, SaysWhatIsWrong) {
  StepProblem::RowMatrix rows(1, 2);
  rows << 1, 0;
  const Problem problem =
      point_problem(Eigen::Vector2d(-1, 0), rows, Eigen::VectorXd::Constant(1, 1));
  const StepProblem view = problem.view();
  nlopt::Task task;
  task.reserve(2);
  ASSERT_TRUE(task.read(view));
  const auto finding = [&](double x, double y) {
    return nlopt::check_answer(Eigen::Vector2d(x, y), view, task, nlopt::NearestPoint(view, task),
                               accuracy)
        .finding;
  };
  EXPECT_EQ(finding(1, 0), NloptFinding::optimal);
  EXPECT_EQ(finding(1 + 1e-9, 1e-9), NloptFinding::optimal);
  EXPECT_EQ(finding(1, 0.1), NloptFinding::not_optimal);
  EXPECT_EQ(finding(2, 0), NloptFinding::not_optimal);
  EXPECT_NE(finding(-1, 0), NloptFinding::optimal);
  EXPECT_EQ(finding(nan, 0), NloptFinding::not_finite);
  EXPECT_EQ(finding(1, infinity), NloptFinding::not_finite);
}

TEST(Contradiction, IsNeverSeenWhereThereIsAFeasiblePoint) {
  for (std::uint64_t seed = 0; seed < 20000; ++seed) {
    const Posed posed(tasks[seed % tasks.size()],
                      plane_kinds[seed / tasks.size() % plane_kinds.size()], seed + 1000000);
    const StepProblem view = posed.problem.view();
    std::vector<std::uint32_t> rows;
    for (std::uint32_t i = 0; i < view.rows.rows(); ++i) rows.push_back(i);
    EXPECT_FALSE(nlopt::contradictory(view, rows, posed.best.norm())) << "seed " << seed;
  }
}

}  // namespace
}  // namespace keepout::test
