// SPDX-License-Identifier: BSD-3-Clause
#include "nearest_point.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace keepout::nlopt {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Unit rows that differ by less count as one. Their constraints then differ by less than the
/// tolerance of a row.
constexpr double parallel = 1e-13;

/// Returns the rows that matter, ascending: the tightest of parallel rows, and the first of equal
/// ones.
std::vector<Index> telling_rows(const StepProblem& problem) {
  const Index n = problem.rows.cols();
  const VectorXd norms = problem.rows.rowwise().norm();
  const StepProblem::RowMatrix units = norms.cwiseInverse().asDiagonal() * problem.rows;
  const VectorXd bounds = problem.bounds.cwiseQuotient(norms);
  // Along this direction, rows agree only if they are parallel.
  const VectorXd direction =
      VectorXd::NullaryExpr(n, [](Index j) { return std::sin(1.0 + static_cast<double>(j * j)); });
  std::vector<std::pair<double, Index>> sorted;
  for (Index i = 0; i < norms.size(); ++i) {
    if (norms[i] > 0) sorted.emplace_back(units.row(i) * direction, i);
  }
  std::ranges::sort(sorted);
  std::vector<std::pair<double, Index>> kept;  // with the key of the first row of its bundle
  for (const auto& [key, row] : sorted) {
    const double least_key = key - parallel * static_cast<double>(n);
    auto twin = kept.rbegin();
    while (twin != kept.rend() && twin->first >= least_key &&
           (units.row(twin->second) - units.row(row)).cwiseAbs().maxCoeff() > parallel) {
      ++twin;
    }
    if (twin == kept.rend() || !(twin->first >= least_key)) {
      kept.emplace_back(key, row);
    } else if (std::pair(-bounds[row], row) < std::pair(-bounds[twin->second], twin->second)) {
      twin->second = row;
    }
  }
  std::vector<Index> rows;
  for (const auto& [key, row] : kept) rows.push_back(row);
  std::ranges::sort(rows);
  return rows;
}

}  // namespace

NearestPoint::NearestPoint(const StepProblem& problem) {
  const Index n = problem.jacobian.cols();
  task_.reserve(static_cast<int>(n));
  task_.read(problem);
  const VectorXd target = task_.target().head(n);
  unconstrained_ = target;
  task_.point_from_task(unconstrained_);

  const std::vector<Index> rows = telling_rows(problem);
  const auto k = static_cast<Index>(rows.size());
  normals.resize(k, n);
  bounds.resize(k);
  VectorXd normal(n);
  for (Index i = 0; i < k; ++i) {
    const auto row = problem.rows.row(rows[static_cast<std::size_t>(i)]);
    task_.row_to_task(row.data(), normal);
    const double length = normal.norm();
    normals.row(i) = normal.transpose() / length;
    bounds[i] =
        (problem.bounds[rows[static_cast<std::size_t>(i)]] - row.dot(unconstrained_)) / length;
  }

  // The larger of the desired motion and the obstacles.
  const double asked = task_.desired() / std::sqrt(static_cast<double>(n));
  scale_ = std::max({target.norm(), asked, k > 0 ? bounds.maxCoeff() : 0.0});
  if (!(scale_ > active_set::smallest)) scale_ = 1;
  bounds /= scale_;
  rest = -target / scale_;
}

VectorXd NearestPoint::variables_at(const VectorXd& z) const {
  // The change of u by z, which is exact if z is zero.
  VectorXd u = scale_ * z;
  task_.point_from_task(u);
  return unconstrained_ + u;
}

}  // namespace keepout::nlopt
