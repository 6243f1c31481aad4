// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <vector>

#include "keepout/fixtures/random_problems.h"
#include "keepout/solvers/registry.h"
#include "realtime/counted_allocations.h"

namespace keepout::test {
namespace {

TEST(SolverAllocation, OurOwnSolverAllocatesNothingAfterReserve) {
  // Covers all sizes, tasks, kinds of planes and outcomes.
  std::vector<Problem> problems;
  for (int n = 1; n <= 12; ++n) {
    for (const Task task : tasks) {
      for (const Planes planes : plane_kinds) {
        Random random(static_cast<std::uint64_t>(problems.size()));
        Problem& problem = problems.emplace_back();
        make_task(problem, task, n, random);
        make_planes(problem, planes, random.vector(n), 100, random);
      }
    }
  }
  Random random(1);
  for (std::size_t i = 0; i < 10; ++i) {
    problems.push_back(problems[i]);
    make_infeasible(problems.back(), 1.0, random);
    problems.push_back(problems[i]);
    problems.back().bounds[0] = std::nan("");
    problems.push_back(problems[i]);
    problems.back().jacobian.setZero();
    problems.push_back(problems[i]);
    problems.back().rows.setZero(2000, problems[i].rows.cols());
    problems.back().bounds.setZero(2000);
  }

  const auto solver = make_solver("active_set");
  solver->reserve(12, 1000);
  std::vector<int> outcomes(6);
  const std::size_t before = allocations();
  for (const Problem& problem : problems) {
    Solution solution;
    ++outcomes[static_cast<std::size_t>(solver->solve(problem.view(), solution))];
  }
  EXPECT_EQ(allocations(), before);
  for (const SolveStatus status :
       {SolveStatus::optimal, SolveStatus::infeasible, SolveStatus::ill_posed,
        SolveStatus::invalid_input, SolveStatus::over_capacity}) {
    EXPECT_GT(outcomes[static_cast<std::size_t>(status)], 0) << name(status);
  }
}

}  // namespace
}  // namespace keepout::test
