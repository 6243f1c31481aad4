// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "keepout/step/solver.h"

namespace keepout {

/// A solver whose answer is a function of the test.
class StubSolver final : public Solver {
 public:
  using Answer = std::function<SolveStatus(const StepProblem&, Solution&)>;

  explicit StubSolver(Answer answer) : answer_(std::move(answer)) {}
  void reserve(int, int) override {}
  SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept override {
    return answer_(problem, solution);
  }

 private:
  Answer answer_;
};

inline std::unique_ptr<Solver> solver_that(StubSolver::Answer answer) {
  return std::make_unique<StubSolver>(std::move(answer));
}

/// Returns a solver that reports the desired motion as optimal, even if it violates the rows.
inline std::unique_ptr<Solver> liar() {
  return solver_that([](const StepProblem& problem, Solution& solution) {
    solution.u = {problem.desired.data(), 3};
    return SolveStatus::optimal;
  });
}

}  // namespace keepout
