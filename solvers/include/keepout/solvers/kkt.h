// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/step/solver.h"

namespace keepout {

/// The violation of the conditions of Karush, Kuhn and Tucker by a claimed optimum. For a convex
/// problem they are necessary and sufficient. 0 means no violation. All members are relative,
/// independent of the unit of length, the scale of a row and the condition of J.
///
/// Lengths of u are divided by the length of the motion or of the target: max(|u|, |d| / |J|).
///
/// Gradients are divided by |d| + sum of half multiplier_i |w_i|. Gradient and rows are first
/// transformed to task space, w = R^-T a with J^T J + damping I = R^T R. In task space the cost is
/// a distance, and the residual bounds the distance to the optimum.
struct KktResidual {
  double stationarity = 0;  // |J^T (J u - d) + damping u - sum of half multiplier_i A_i^T|
  double primal = 0;  // the largest violation / |A_i|; infinite for a row of zeros with b_i > 0
  double dual = 0;    // the most negative multiplier, as a force
  double complementarity = 0;  // the largest |slack| / |A_i| of a row with a multiplier

  /// Returns the largest of the four members.
  double worst() const noexcept;
};

/// Returns the KKT residual of a solution, computed independently of any solver and in extended
/// precision. All members are infinite for a malformed solution: wrong sizes, numbers that are not
/// finite, rows out of range, out of order or duplicate. Allocates: for tests and benchmarks.
KktResidual kkt_residual(const StepProblem& problem, const Solution& solution);

}  // namespace keepout
