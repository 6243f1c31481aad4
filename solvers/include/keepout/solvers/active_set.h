// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/step/solver.h"

namespace keepout {

/// The dual active-set method for strictly convex quadratic programs. It starts from the
/// unconstrained minimum and adds the most violated row until all rows are satisfied. Its work
/// therefore depends mainly on the active rows, and it proves infeasibility.
///
/// Bounds must be finite (omit rows without a bound) and all numbers below 1e70. A row of zeros is
/// satisfied if its bound is at most 0, and infeasible otherwise. Among equal rows, the one with
/// the lowest index is active.
///
/// An `optimal` solution satisfies each row to about 1e-13 of the length of the motion, or to 1e-11
/// at a vertex of nearly parallel planes. The status `infeasible` excludes every motion up to 1000
/// times as long as those tried. If rounding decides between the two, the status is
/// `iteration_limit`. Details: active_set_tolerances.h.
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
