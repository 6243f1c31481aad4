// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <concepts>
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
  int iterations = 0;
};

/// Solves one step problem after another, without allocating.
///
/// At an optimum, 2 J^T (J u - d) + 2 damping u = sum over active rows i of multipliers_i A_i^T.
class Solver {
 public:
  virtual ~Solver() = default;

  /// Makes room. Allocates; everything after it does not.
  virtual void reserve(int variables, int rows) = 0;

  virtual SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept = 0;
};

/// What `step` needs of a solver; a final class that satisfies it is called without dispatch.
template <class T>
concept QpSolver = requires(T& solver, const StepProblem& problem, Solution& solution) {
  requires noexcept(solver.solve(problem, solution));
  { solver.solve(problem, solution) } -> std::same_as<SolveStatus>;
};

}  // namespace keepout
