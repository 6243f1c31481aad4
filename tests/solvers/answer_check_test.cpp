// SPDX-License-Identifier: BSD-3-Clause
// The judge of NLopt's answers, given answers that are wrong.
#include "answer_check.h"

#include "keepout/solvers/active_set.h"
#include "solvers/solver_contract.h"

namespace keepout::test {
namespace {

constexpr double accuracy = 1e-6;

/// A problem, and its optimum.
struct Posed {
  Posed(Task kind, Planes planes, std::uint64_t seed) : random(seed) {
    const int n = random.integer(1, 7);
    problem = make_problem(kind, planes, n, random.integer(0, 60), random);
    exact.reserve(n, 60);
    judge.reserve(n, 60);
    EXPECT_EQ(exact.solve(problem.view(), solution), SolveStatus::optimal);
    best = vector(solution.u);
  }

  NloptFinding check(const Eigen::VectorXd& u) {
    return judge.judge(u, problem.view(), solution, accuracy, answer);
  }

  /// In task space.
  double length(const Eigen::VectorXd& v) const {
    return std::sqrt((problem.jacobian * v).squaredNorm() + problem.damping * v.squaredNorm());
  }

  Random random;
  Problem problem;
  ActiveSet exact;
  Solution solution;
  Eigen::VectorXd best;
  nlopt::AnswerCheck judge;
  Solution answer;
};

TEST(AnswerCheck, AcceptsTheOptimum) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    Posed posed(Task::square, Planes::touching, seed);
    ASSERT_EQ(posed.check(posed.best), NloptFinding::optimal) << "seed " << seed;
    EXPECT_LE((vector(posed.answer.u) - posed.best).norm(), 1e-9 * posed.best.norm())
        << "seed " << seed;
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
    if (posed.check(lie) != NloptFinding::optimal) {
      ++rejected;
      continue;
    }
    ++accepted;
    const double reach = std::max(posed.length(posed.best), posed.problem.desired.norm());
    const double off = posed.length(vector(posed.answer.u) - posed.best);
    EXPECT_LE(off, 1.01 * accuracy * reach) << "seed " << seed;
    EXPECT_LE(kkt_residual(posed.problem.view(), posed.answer).worst(), accuracy)
        << "seed " << seed;
  }
  EXPECT_GT(accepted, trials(1200));
  EXPECT_GT(rejected, trials(1200));
}

TEST(AnswerCheck, SaysWhatIsWrong) {
  StepProblem::RowMatrix rows(1, 2);
  rows << 1, 0;
  const Problem problem =
      point_problem(Eigen::Vector2d(-1, 0), rows, Eigen::VectorXd::Constant(1, 1));
  ActiveSet exact;
  exact.reserve(2, 1);
  Solution best, answer;
  ASSERT_EQ(exact.solve(problem.view(), best), SolveStatus::optimal);
  nlopt::AnswerCheck judge;
  judge.reserve(2, 1);
  const auto finding = [&](double x, double y) {
    return judge.judge(Eigen::Vector2d(x, y), problem.view(), best, accuracy, answer);
  };
  EXPECT_EQ(finding(1, 0), NloptFinding::optimal);
  EXPECT_EQ(finding(1 + 1e-9, 1e-9), NloptFinding::optimal);
  EXPECT_EQ(finding(1, 0.1), NloptFinding::not_optimal);
  EXPECT_EQ(finding(2, 0), NloptFinding::not_optimal);
  EXPECT_NE(finding(-1, 0), NloptFinding::optimal);
  EXPECT_EQ(finding(nan, 0), NloptFinding::not_finite);
  EXPECT_EQ(finding(1, infinity), NloptFinding::not_finite);
}

}  // namespace
}  // namespace keepout::test
