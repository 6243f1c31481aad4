// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/step/solver.h"

namespace keepout {

/// How far a claimed optimum is from satisfying the conditions of Karush, Kuhn and Tucker, which
/// for a convex problem are the whole truth about an optimum. 0 is perfect; all are relative, so
/// that neither the unit of length, nor the scale of a row, nor the condition of J matters:
///
/// lengths of u against  reach  = max(|u|, |d| / |J|), the motion or what was asked for;
/// gradients against     forces = |d| + sum of half multiplier_i |w_i|, where both the gradient and
///                       the rows are taken to task space, w = R^-T a with J^T J + damping I =
///                       R^T R: there the cost is a distance, and the residual bounds it.
struct KktResidual {
  double stationarity = 0;     // |J^T (J u - d) + damping u - sum of half multiplier_i A_i^T|
  double primal = 0;           // the worst violation / |A_i|; infinite for a row of zeros, b_i > 0
  double dual = 0;             // the most negative multiplier, as a force
  double complementarity = 0;  // the worst |slack| / |A_i| of a row with a multiplier

  /// The largest of the four.
  double worst() const noexcept;
};

/// Checks a solution against its problem, independently of any solver and in extended precision.
/// Infinite throughout if the solution is no solution in form: sizes that do not fit, numbers that
/// are not finite, rows out of range, out of order or twice. Allocates: for tests and benchmarks.
KktResidual kkt_residual(const StepProblem& problem, const Solution& solution);

}  // namespace keepout
