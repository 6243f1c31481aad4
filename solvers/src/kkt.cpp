// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/solvers/kkt.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace keepout {
namespace {

using Real = long double;
using RealVector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
using RealMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

constexpr double infinite = std::numeric_limits<double>::infinity();

bool well_formed(const StepProblem& problem, const Solution& solution) {
  if (static_cast<Eigen::Index>(solution.u.size()) != problem.jacobian.cols()) return false;
  if (solution.active.size() != solution.multipliers.size()) return false;
  const auto finite = [](double x) { return std::isfinite(x); };
  if (!std::ranges::all_of(solution.u, finite)) return false;
  if (!std::ranges::all_of(solution.multipliers, finite)) return false;
  for (std::size_t i = 0; i < solution.active.size(); ++i) {
    if (solution.active[i] >= problem.rows.rows()) return false;
    if (i > 0 && solution.active[i] <= solution.active[i - 1]) return false;
  }
  return true;
}

/// Returns the upper triangle R of the QR factors of [J; sqrt(damping) I].
RealMatrix task_factor(const StepProblem& problem) {
  const Eigen::Index k = problem.jacobian.rows();
  const Eigen::Index n = problem.jacobian.cols();
  RealMatrix stacked(k + n, n);
  stacked.topRows(k) = problem.jacobian.cast<Real>();
  stacked.bottomRows(n) = RealMatrix::Identity(n, n) * std::sqrt(Real{problem.damping});
  return Eigen::HouseholderQR<RealMatrix>(stacked).matrixQR().topRows(n);
}

/// Returns part / whole, where 0 / 0 is 0 and NaN counts as infinite.
double relative(Real part, Real whole) {
  if (part == 0) return 0;
  const auto value = static_cast<double>(part / whole);
  return std::isnan(value) ? infinite : value;
}

}  // namespace

double KktResidual::worst() const noexcept {
  return std::max({stationarity, primal, dual, complementarity});
}

KktResidual kkt_residual(const StepProblem& problem, const Solution& solution) {
  if (!well_formed(problem, solution)) return {infinite, infinite, infinite, infinite};
  const RealMatrix jacobian = problem.jacobian.cast<Real>();
  const RealVector desired = problem.desired.cast<Real>();
  const RealVector u =
      Eigen::Map<const Eigen::VectorXd>(solution.u.data(), problem.jacobian.cols()).cast<Real>();
  const Real asked = desired.norm() > 0 ? desired.norm() / jacobian.norm() : Real{0};
  const Real reach = std::max(u.norm(), asked);
  KktResidual residual;

  for (Eigen::Index i = 0; i < problem.rows.rows(); ++i) {
    const RealVector a = problem.rows.row(i).transpose().cast<Real>();
    const Real violation = problem.bounds[i] - a.dot(u);
    if (!(violation <= 0)) {
      residual.primal = std::max(residual.primal, relative(violation, a.norm() * reach));
    }
  }

  const RealMatrix factor = task_factor(problem);
  const auto to_task = [&factor](const RealVector& gradient) -> RealVector {
    return factor.transpose().triangularView<Eigen::Lower>().solve(gradient);
  };
  RealVector gradient = jacobian.transpose() * (jacobian * u - desired) + problem.damping * u;
  Real forces = desired.norm();
  Real pulling = 0;
  for (std::size_t i = 0; i < solution.active.size(); ++i) {
    const RealVector a = problem.rows.row(solution.active[i]).transpose().cast<Real>();
    const Real half = Real{solution.multipliers[i]} / 2;
    const Real force = half * to_task(a).norm();
    gradient -= half * a;
    forces += std::abs(force);
    pulling = std::max(pulling, -force);
    const Real slack = std::abs(a.dot(u) - problem.bounds[solution.active[i]]);
    residual.complementarity =
        std::max(residual.complementarity, relative(slack, a.norm() * reach));
  }
  residual.stationarity = relative(to_task(gradient).norm(), forces);
  residual.dual = relative(pulling, forces);
  return residual;
}

}  // namespace keepout
