// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/enumeration_oracle.h"

#include <Eigen/LU>
#include <limits>

namespace keepout::test {
namespace {

using Real = long double;
using RealVector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
using RealMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

/// A vertex computed in 64 bits of mantissa from numbers of size 1 is feasible to this.
constexpr Real tolerance = 1e-13L;

}  // namespace

std::optional<Eigen::VectorXd> enumerate_minimum(const StepProblem& problem) {
  const Eigen::Index n = problem.jacobian.cols();
  const Eigen::Index m = problem.rows.rows();
  const RealMatrix jacobian = problem.jacobian.cast<Real>();
  const RealVector desired = problem.desired.cast<Real>();
  const RealMatrix rows = problem.rows.cast<Real>();
  const RealVector bounds = problem.bounds.cast<Real>();
  const RealMatrix hessian =
      jacobian.transpose() * jacobian + RealMatrix::Identity(n, n) * Real{problem.damping};
  const RealVector pull = jacobian.transpose() * desired;

  std::optional<Eigen::VectorXd> best;
  Real least = std::numeric_limits<Real>::infinity();
  for (unsigned set = 0; set < 1U << m; ++set) {
    const Eigen::Index active = __builtin_popcount(set);
    if (active > n) continue;
    RealMatrix system = RealMatrix::Zero(n + active, n + active);
    RealVector right(n + active);
    system.topLeftCorner(n, n) = hessian;
    right.head(n) = pull;
    for (Eigen::Index i = 0, at = n; i < m; ++i) {
      if ((set >> i & 1U) == 0) continue;
      system.row(at).head(n) = rows.row(i);
      system.col(at).head(n) = rows.row(i).transpose();
      right[at++] = bounds[i];
    }
    const Eigen::FullPivLU<RealMatrix> lu(system);
    if (!lu.isInvertible()) continue;  // another set spans the same rows
    const RealVector u = lu.solve(right).head(n);
    if (m > 0 && (rows * u - bounds).minCoeff() < -tolerance) continue;
    const Real cost = (jacobian * u - desired).squaredNorm() + problem.damping * u.squaredNorm();
    if (cost < least) {
      least = cost;
      best = u.cast<double>();
    }
  }
  return best;
}

}  // namespace keepout::test
