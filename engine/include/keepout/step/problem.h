// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace keepout {

/// The step as a small convex quadratic program (Li et al. 2020, eq. 1):
///
///     min  |J u - d|^2 + damping |u|^2    subject to    A u >= b
///
/// Views only: whoever poses the problem owns the numbers. n variables, k task rows, m constraints.
struct StepProblem {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic>;
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Vector = Eigen::VectorXd;

  Eigen::Map<const Matrix> jacobian;  // J (k, n)
  Eigen::Map<const Vector> desired;   // d (k) [length]
  Eigen::Map<const RowMatrix> rows;   // A (m, n)
  Eigen::Map<const Vector> bounds;    // b (m)
  double damping = 0.0;               // >= 0; above 0 makes any J well-posed
};

}  // namespace keepout
