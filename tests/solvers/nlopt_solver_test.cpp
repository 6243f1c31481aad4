// SPDX-License-Identifier: BSD-3-Clause
// Properties beyond the contract of all solvers: the report of NLopt's claims, which are never
// trusted.
#include "keepout/solvers/nlopt_solver.h"

#include "answer_check.h"
#include "keepout/solvers/active_set.h"
#include "keepout/testing/solver_trials.h"

namespace keepout::test {
namespace {

/// Returns a problem with the row x >= 1 and a target on its forbidden side.
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
  bounds << 0, 2, -9, 3, 1;  // x >= 0, three times x >= 1, and y >= -9
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

// Gives wrong answers to the judge of NLopt's answers.

constexpr double accuracy = 1e-6;

/// A problem and its optimum.
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

  /// Returns the length of a motion in task space.
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
  // The errors range from last digits to wild guesses, in any direction, for every kind of problem.
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
