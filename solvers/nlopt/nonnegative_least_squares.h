// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace keepout::nlopt {

/// The point of a cone nearest to a target: sum weights_i column_i, with weights > 0 on columns
/// that are independent, and the residual that is left, target - sum.
struct NonnegativeCombination {
  std::vector<Eigen::Index> columns;  // ascending
  Eigen::VectorXd weights;            // of these
  Eigen::VectorXd residual;
};

/// min |columns x - target| subject to x >= 0. The columns are unit vectors. May stop short of the
/// minimum where rounding does not let it go on: whoever uses the answer checks it.
///
/// Source: Lawson, Hanson, "Solving least squares problems", 1974, chapter 23.
NonnegativeCombination nonnegative_least_squares(const Eigen::MatrixXd& columns,
                                                 const Eigen::VectorXd& target);

}  // namespace keepout::nlopt
