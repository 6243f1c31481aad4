// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "keepout/geometry/half_space.h"

namespace keepout {

/// The step as a small convex quadratic program (Li et al. 2020, eq. 1):
///
///     min  |J u - d|^2 + damping |u|^2    subject to    A u >= b
///
/// Views only: whoever poses the problem owns the numbers. n variables, k task rows, m constraints.
struct StepProblem {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic>;  // column by column
  /// Row by row.
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Vector = Eigen::VectorXd;  // of any length

  Eigen::Map<const Matrix> jacobian;  // J (k, n)
  Eigen::Map<const Vector> desired;   // d (k) [length]
  Eigen::Map<const RowMatrix> rows;   // A (m, n)
  Eigen::Map<const Vector> bounds;    // b (m)
  double damping = 0.0;               // >= 0; above 0 makes any J well-posed
  /// The planes that the first rows come from, A_i = n_i^T J, b_i = offset, J (3, n); none if
  /// unknown. A solver that reads them may be posed a problem whose first rows are not written.
  std::span<const HalfSpace> planes = {};
};

/// Row i of A for a plane: n^T J, J (3, n) column by column. Every sum in one order, so that a row
/// has the same bits whoever writes it.
inline void write_row(const Vec3& normal, const double* jacobian, Eigen::Index variables,
                      double* row) noexcept {
  for (Eigen::Index c = 0; c < variables; ++c, jacobian += 3) {
    row[c] = normal[0] * jacobian[0] + normal[1] * jacobian[1] + normal[2] * jacobian[2];
  }
}

/// Whether u is the increment of a point itself: three variables, J = I and no damping. The answer
/// is then the point of the feasible set that is nearest to d.
inline bool moves_a_point(const StepProblem& problem) noexcept {
  if (problem.jacobian.cols() != 3 || problem.jacobian.rows() != 3) return false;
  const double* j = problem.jacobian.data();
  return problem.damping == 0.0 && j[0] == 1.0 && j[1] == 0.0 && j[2] == 0.0 && j[3] == 0.0 &&
         j[4] == 1.0 && j[5] == 0.0 && j[6] == 0.0 && j[7] == 0.0 && j[8] == 1.0;
}

}  // namespace keepout
