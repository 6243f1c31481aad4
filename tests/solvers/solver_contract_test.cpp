// SPDX-License-Identifier: BSD-3-Clause
// The contract of every solver of the registry, and the registry.
#include "keepout/testing/solver_contract.h"

#include "keepout/solvers/active_set.h"
#include "keepout/solvers/recording_solver.h"
#include "messages.h"

namespace keepout::test {
namespace {

/// Returns the measured limits of the solvers of libraries. keepout's own solver must never give
/// up.
Allowance allowance_of(std::string_view solver) {
  // Strides are prime numbers, because the kinds of problems alternate with small periods.
  const auto stride = [](int in_long, int in_short) { return all_trials() ? in_long : in_short; };
  if (solver == "nlopt_slsqp") return {stride(7, 29), 2000, {0.01, 0.02, 0.35}};
  if (solver == "nlopt_cobyla") return {stride(163, 653), 400, {0.1, 0.3, 0.6}};
  if (solver == "nlopt_mma") return {stride(797, 3191), 20, {0.3, 0.5, 0.9}};
  return {};
}

std::vector<SolverUnderTest> solvers_under_test() {
  std::vector<SolverUnderTest> all;
  for (const SolverBackend& backend : solver_backends()) {
    all.push_back({backend, allowance_of(backend.name)});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Solvers, SolverContract, testing::ValuesIn(solvers_under_test()), by_name);

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
