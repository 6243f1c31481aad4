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

  /// Whether rows that no iterate violates have no bearing on the answer, not even on its last bit,
  /// and all iterates for the nearest point to d are projections of d on some of the rows: so it is
  /// with a dual active-set method.
  virtual bool skips_idle_rows() const noexcept { return false; }

  /// The u of least cost that satisfies all rows. Fills `solution` when optimal; otherwise what is
  /// in it may not be used. More variables or rows than reserved: `over_capacity`.
  virtual SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept = 0;

  /// Whether it takes rows that come from planes from the planes, so that they need not be written.
  virtual bool reads_planes() const noexcept { return false; }
};

/// What `step` needs of a solver; a final class that satisfies it is called without dispatch.
template <class T>
concept QpSolver = requires(T& solver, const StepProblem& problem, Solution& solution) {
  requires noexcept(solver.solve(problem, solution));
  { solver.solve(problem, solution) } -> std::same_as<SolveStatus>;
};

/// The same of any solver; one that does not say reads rows.
template <QpSolver S>
bool reads_planes(const S& solver) noexcept {
  if constexpr (requires { solver.reads_planes(); }) return solver.reads_planes();
  return false;
}

/// The same of any solver; one that does not say does not skip them.
template <QpSolver S>
bool skips_idle_rows(const S& solver) noexcept {
  if constexpr (requires { solver.skips_idle_rows(); }) return solver.skips_idle_rows();
  return false;
}

}  // namespace keepout
