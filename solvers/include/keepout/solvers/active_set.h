// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/step/solver.h"

namespace keepout {

/// The dual active-set method for strictly convex quadratic programs: starts from the
/// unconstrained minimum and adds the most violated row until none is left, so that its work is
/// that of the rows which matter and an infeasible problem is recognized, not guessed.
///
/// Bounds must be finite (leave out a row that asks for nothing) and all numbers below 1e70. A row
/// of zeros is satisfied if its bound is at most 0, and infeasible otherwise. Equal rows: the
/// lowest index is the active one. "optimal" satisfies each row to some 1e-13 of the length of the
/// motion, or in a vertex of nearly parallel planes to 1e-11; "infeasible" rules out every motion
/// up to 1000 times the length of those tried; where rounding decides between the two, the answer
/// is "iteration_limit". How: see active_set_tolerances.h.
///
/// Source: Goldfarb, Idnani, "A numerically stable dual method for solving strictly convex
/// quadratic programs", Mathematical Programming 27, 1983.
class ActiveSet final : public Solver {
 public:
  ActiveSet();
  ~ActiveSet() override;

  void reserve(int variables, int rows) override;
  SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept override;
  bool reads_planes() const noexcept override { return true; }
  bool ignores_idle_planes() const noexcept override { return true; }

 private:
  struct Workspace;
  std::unique_ptr<Workspace> work_;
};

}  // namespace keepout
