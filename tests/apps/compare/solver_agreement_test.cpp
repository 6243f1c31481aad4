// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <numeric>

#include "compare/agreement.h"
#include "keepout/error.h"
#include "keepout/solvers/active_set.h"
#include "keepout/solvers/registry.h"
#include "meshes.h"

namespace keepout::app {
namespace {

std::shared_ptr<const Mesh> cortex() {
  static const auto mesh = mesh_of("cortex");
  return mesh;
}

TEST(RecordedProblems, AreTheSameForTheSameSeedAndHaveRows) {
  const auto first = record_problems(cortex(), "certified", 60, 3);
  const auto second = record_problems(cortex(), "certified", 60, 3);
  ASSERT_EQ(first.size(), 60u);
  ASSERT_EQ(second.size(), 60u);
  Eigen::Index rows = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].rows, second[i].rows);
    EXPECT_EQ(first[i].desired, second[i].desired);
    rows += first[i].rows.rows();
  }
  EXPECT_GT(rows, 30);
}

TEST(RecordedProblems, AContradictionLeavesNoSolution) {
  Random random(5);
  ActiveSet solver;
  solver.reserve(7, 4000);
  for (RecordedProblem& problem : record_problems(cortex(), "all_faces", 100, 4)) {
    contradict(problem, random);
    Solution solution;
    EXPECT_EQ(solver.solve(problem.view(), solution), SolveStatus::infeasible);
  }
}

TEST(SolverAgreement, CountsEveryProblemOnceAndNoSolverIsWrong) {
  SolverComparison comparison{
      .rules = {"certified", "paper"}, .solvers = {}, .problems = 120, .seed = 2, .most = {}};
  for (const SolverBackend& backend : solver_backends()) {
    comparison.solvers.emplace_back(backend.name);
    if (backend.library != nullptr) comparison.most[comparison.solvers.back()] = 20;
  }
  const std::vector<SolverAgreement> rows = compare_solvers(cortex(), comparison);
  ASSERT_EQ(rows.size(), 2 * comparison.solvers.size());
  for (const SolverAgreement& row : rows) {
    EXPECT_EQ(row.problems, row.solver == "active_set" ? 120u : 20u) << row.solver;
    EXPECT_EQ(row.optimal + row.infeasible + row.gave_up, row.problems) << row.solver;
    EXPECT_EQ(row.wrong, 0u) << row.solver << ", " << row.activation;
    EXPECT_GT(row.optimal, row.problems / 2) << row.solver << ", " << row.activation;
    EXPECT_LE(row.median_us, row.p99_us);
    const std::size_t outcomes =
        std::accumulate(row.outcomes.begin(), row.outcomes.end(), std::size_t{0},
                        [](std::size_t sum, const auto& entry) { return sum + entry.second; });
    EXPECT_EQ(outcomes, row.problems) << row.solver;
  }
}

TEST(SolverAgreement, AnUnknownSolverIsNamed) {
  const SolverComparison comparison{
      .rules = {"certified"}, .solvers = {"simplex"}, .problems = 10, .most = {}};
  EXPECT_THROW(compare_solvers(cortex(), comparison), Error);
}

}  // namespace
}  // namespace keepout::app
