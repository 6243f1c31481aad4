// SPDX-License-Identifier: BSD-3-Clause
// Input that solvers must reject, and the registry.
#include "keepout/solvers/active_set.h"
#include "keepout/solvers/recording_solver.h"
#include "messages.h"
#include "solvers/solver_contract.h"

namespace keepout::test {
namespace {

using SolverInput = SolverContract;

INSTANTIATE_TEST_SUITE_P(Solvers, SolverInput, testing::ValuesIn(solver_backends()), by_name);

Problem valid_problem() {
  Random random(42);
  Problem problem;
  make_task(problem, Task::square, 3, random);
  make_planes(problem, Planes::scattered, Eigen::Vector3d::Zero(), 5, random);
  return problem;
}

TEST_P(SolverInput, AnyNumberThatIsNotFiniteIsRefused) {
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

TEST_P(SolverInput, NotFiniteBoundsOfZeroRowsAreRefused) {
  for (const double bad : {nan, infinity, -infinity}) {
    Problem problem = valid_problem();
    problem.rows.row(2).setZero();
    problem.bounds[2] = bad;
    EXPECT_EQ(solve(problem), SolveStatus::invalid_input) << bad;
  }
}

TEST_P(SolverInput, NegativeDampingIsRefused) {
  Problem problem = valid_problem();
  problem.damping = -1e-9;
  EXPECT_EQ(solve(problem), SolveStatus::invalid_input);
}

TEST_P(SolverInput, ShapesThatDisagreeAreRefused) {
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

TEST_P(SolverInput, MoreThanReservedIsRefusedAndNotTruncated) {
  solver_->reserve(3, 5);
  EXPECT_TRUE(optimal(valid_problem()));
  solver_->reserve(3, 4);
  EXPECT_EQ(solve(valid_problem()), SolveStatus::over_capacity);
  solver_->reserve(2, 5);
  EXPECT_EQ(solve(valid_problem()), SolveStatus::over_capacity);
  EXPECT_TRUE(solution_.u.empty());
}

TEST_P(SolverInput, ATaskThatLeavesADirectionFreeIsIllPosed) {
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

TEST(SolverRegistry, MakesEverySolverByName) {
  ASSERT_FALSE(solver_backends().empty());
  for (const SolverBackend& backend : solver_backends()) {
    EXPECT_NE(make_solver(backend.name), nullptr) << backend.name;
    EXPECT_FALSE(backend.description.empty()) << backend.name;
  }
}

TEST(SolverRegistry, AnUnknownNameListsTheKnownOnes) {
  const std::string message = error_of([] { make_solver("simplex"); });
  EXPECT_CONTAINS(message, "simplex");
  for (const SolverBackend& backend : solver_backends()) EXPECT_CONTAINS(message, backend.name);
}

TEST(SolverRegistry, AnAbsentSolverSaysWhatItNeeds) {
  for (const PeerPart& part : solver_backends().absent()) {
    EXPECT_CONTAINS(error_of([&] { make_solver(part.name); }), part.needs);
  }
}

TEST(SolverRegistry, LibrariesStateTheirVersionAndOurOwnNone) {
  for (const SolverBackend& backend : solver_backends()) {
    EXPECT_EQ(backend.library == nullptr, backend.allocation == Allocation::never) << backend.name;
    if (backend.library != nullptr) {
      EXPECT_CONTAINS(backend.library(), '.');
    }
    EXPECT_GT(backend.accuracy, 0) << backend.name;
    EXPECT_LE(backend.accuracy, 1e-5) << backend.name;
  }
}

TEST(SolveStatus, EveryStatusHasANameOfItsOwn) {
  std::vector<std::string_view> names;
  for (int status = 0; status <= static_cast<int>(SolveStatus::iteration_limit); ++status) {
    names.push_back(name(static_cast<SolveStatus>(status)));
    EXPECT_FALSE(names.back().empty());
  }
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::adjacent_find(names), names.end());
}

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
