// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "active_set_task.h"
#include "keepout/step/problem.h"

namespace keepout::nlopt {

using Task = active_set::TaskSpace<Eigen::Dynamic>;

/// The step problem as NLopt gets it, without units: in task space, where the cost is a distance,
/// and counted from what the task alone would choose, u0 = R^-1 c, in multiples of a length of the
/// problem. With R u = c + scale z it is
///
///     min |z|^2 / 2    subject to    normals z >= bounds
///
/// with unit normals. Gradients are then of order 1, without which SLSQP fails (NLopt's issues 86
/// and 375), and the best conditioned that there are.
struct NearestPoint {
  /// Preconditions: the task has read the problem, which is in range.
  NearestPoint(const StepProblem& problem, const Task& task);

  /// R^-1 (c + scale z)
  Eigen::VectorXd variables_at(const Eigen::VectorXd& z, const Task& task) const;

  StepProblem::RowMatrix normals;   // (k, n)
  Eigen::VectorXd bounds;           // (k)
  Eigen::VectorXd lengths;          // (k) |R^-T a|: of the rows before they were made unit rows
  std::vector<std::uint32_t> rows;  // (k) of the problem, ascending
  Eigen::VectorXd rest;             // (n) where z is when u is 0
  Eigen::VectorXd unconstrained;    // (n) u0
  double scale = 1;
};

}  // namespace keepout::nlopt
