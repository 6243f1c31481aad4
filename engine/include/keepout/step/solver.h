// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string_view>

#include "keepout/step/problem.h"

namespace keepout {

/// How a solve ended. Only `optimal` carries a solution that may be used.
enum class SolveStatus : std::uint8_t {
  optimal,         // feasible, and no feasible point is better
  infeasible,      // no u satisfies all rows
  ill_posed,       // the minimiser is not unique: J lacks full column rank and damping is 0
  invalid_input,   // a number is not finite or out of range, or the shapes do not agree
  over_capacity,   // more variables or rows than reserved
  iteration_limit  // gave up: the budget of work is spent, or rounding hides the answer
};

/// One line on what happened and why.
std::string_view reason(SolveStatus status) noexcept;

/// What a solver leaves behind. Views into the solver's own memory, valid until its next solve.
struct Solution {
  std::span<const double> u;              // (n); meaningful only when optimal
  std::span<const double> multipliers;    // (active.size()), >= 0, of the active rows: see Solver
  std::span<const std::uint32_t> active;  // the rows that hold with equality and push
  int iterations = 0;  // of the method's own kind: to compare a solver with itself
};

/// Solves one step problem after another, without allocating.
///
/// At an optimum, 2 J^T (J u - d) + 2 damping u = sum over active rows i of multipliers_i A_i^T.
class Solver {
 public:
  virtual ~Solver() = default;

  /// Makes room. Allocates; everything after it does not.
  virtual void reserve(int variables, int rows) = 0;

  /// The u of least cost that satisfies all rows. Fills `solution` when optimal; otherwise what is
  /// in it may not be used. More variables or rows than reserved: `over_capacity`.
  virtual SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept = 0;

  /// Whether it takes rows that come from planes from StepProblem::planes, so that they need not be
  /// written; and whether planes that no iterate violates have no bearing on the answer, not even
  /// on its last bit, while all iterates for the point nearest to d are its projections on some of
  /// them. So it is with a dual active-set method.
  virtual bool reads_planes() const noexcept { return false; }
};

}  // namespace keepout
