// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "contradiction.h"

#include <algorithm>
#include <cmath>

#include "active_set_tolerances.h"
#include "nonnegative_least_squares.h"

namespace keepout::nlopt {

using active_set::epsilon;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool contradictory(const StepProblem& problem, std::span<const std::uint32_t> rows, double reach) {
  const Index n = problem.rows.cols();
  const auto k = static_cast<Index>(rows.size());
  if (k == 0) return false;
  MatrixXd units(n, k);
  VectorXd bounds(k);
  for (Index i = 0; i < k; ++i) {
    const auto row = problem.rows.row(rows[static_cast<std::size_t>(i)]).transpose();
    const double norm = row.norm();
    units.col(i) = row / norm;
    bounds[i] = problem.bounds[rows[static_cast<std::size_t>(i)]] / norm;
  }
  // No u that is shorter than the tightest bound satisfies it.
  reach = std::max(reach, bounds.maxCoeff());
  if (!(reach > 0)) return false;

  MatrixXd columns(n + 1, k);
  columns << units, bounds.transpose() / reach;
  columns.colwise().normalize();
  const NonnegativeCombination sum = nonnegative_least_squares(columns, VectorXd::Unit(n + 1, n));

  VectorXd left = VectorXd::Zero(n);
  double right = 0;
  double size = 0;
  double bound_size = 0;
  for (std::size_t i = 0; i < sum.columns.size(); ++i) {
    const Index c = sum.columns[i];
    const double weight = sum.weights[static_cast<Index>(i)] / std::hypot(1.0, bounds[c] / reach);
    left += weight * units.col(c);
    right += weight * bounds[c];
    size += weight;
    bound_size += weight * std::abs(bounds[c]);
  }
  const auto terms = static_cast<double>(n + 1);
  if (!(left.norm() <= active_set::dependence * size)) return false;
  return right > (left.norm() + terms * epsilon * size) * active_set::horizon * reach +
                     2 * terms * epsilon * bound_size;
}

}  // namespace keepout::nlopt
