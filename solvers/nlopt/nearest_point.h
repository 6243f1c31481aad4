// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "active_set_task.h"
#include "keepout/step/solver.h"

namespace keepout::nlopt {

/// The step problem in the form for NLopt, without units. It is in task space, where the cost is a
/// distance. It is relative to the minimum of the task alone, u0 = R^-1 c, in multiples of a length
/// of the problem. With R u = c + scale z it is
///
///     min |z|^2 / 2    subject to    normals z >= bounds
///
/// with unit normals. Gradients are then of order 1, without which SLSQP fails (NLopt's issues 86
/// and 375), and the conditioning is the best possible. SLSQP also fails for duplicate rows (its
/// issues 400 and 567). So rows of zeros are dropped, and all but the tightest of rows that are
/// parallel up to rounding.
class NearestPoint {
 public:
  /// Precondition: the problem is in range and well-posed.
  explicit NearestPoint(const StepProblem& problem);

  StepProblem::RowMatrix normals;  // (k, n)
  Eigen::VectorXd bounds;          // (k)
  Eigen::VectorXd rest;            // (n) value of z for u = 0

  /// Returns R^-1 (c + scale z).
  Eigen::VectorXd variables_at(const Eigen::VectorXd& z) const;

 private:
  active_set::TaskSpace<Eigen::Dynamic> task_;
  Eigen::VectorXd unconstrained_;  // (n) u0
  double scale_ = 1;
};

}  // namespace keepout::nlopt
