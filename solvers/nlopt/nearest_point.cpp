// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "nearest_point.h"

#include <algorithm>
#include <cmath>

#include "parallel_rows.h"

namespace keepout::nlopt {

using Eigen::Index;
using Eigen::VectorXd;

NearestPoint::NearestPoint(const StepProblem& problem, const Task& task)
    : rows(without_parallels(problem)) {
  const Index n = problem.jacobian.cols();
  const auto k = static_cast<Index>(rows.size());
  const VectorXd target = task.target().head(n);
  unconstrained = target;
  task.point_from_task(unconstrained);

  normals.resize(k, n);
  bounds.resize(k);
  lengths.resize(k);
  VectorXd normal(n);
  for (Index i = 0; i < k; ++i) {
    const auto row = problem.rows.row(rows[static_cast<std::size_t>(i)]);
    task.row_to_task(row.data(), normal);
    lengths[i] = normal.norm();
    normals.row(i) = normal.transpose() / lengths[i];
    bounds[i] =
        (problem.bounds[rows[static_cast<std::size_t>(i)]] - row.dot(unconstrained)) / lengths[i];
  }

  // The larger of what was asked for and what is in its way.
  const double asked = task.desired() / std::sqrt(static_cast<double>(n));
  scale = std::max({target.norm(), asked, k > 0 ? bounds.maxCoeff() : 0.0});
  if (!(scale > active_set::smallest)) scale = 1;
  bounds /= scale;
  rest = -target / scale;
}

VectorXd NearestPoint::variables_at(const VectorXd& z, const Task& task) const {
  // What z adds to u0, which is exact where z is zero.
  VectorXd u = scale * z;
  task.point_from_task(u);
  return unconstrained + u;
}

}  // namespace keepout::nlopt
