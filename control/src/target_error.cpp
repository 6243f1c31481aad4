// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/target_error.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "keepout/error.h"
#include "keepout/option_table.h"

namespace keepout {
namespace {

constexpr double known = std::numeric_limits<double>::infinity();  // degrees of freedom

/// Returns the probability that the norm of `dimensions` normal numbers of equal variance is at
/// most `radius` standard deviations. The deviation is estimated with `freedom` degrees of freedom,
/// or known. Integrates the density of the norm by Simpson's rule.
double chance_within(double radius, double dimensions, double freedom) {
  const double half = 0.5 * dimensions;
  const double log_scale = freedom == known
                               ? (half - 1.0) * std::numbers::ln2 + std::lgamma(half)
                               : half * std::log(freedom) - std::numbers::ln2 + std::lgamma(half) +
                                     std::lgamma(0.5 * freedom) - std::lgamma(half + 0.5 * freedom);
  const auto density = [&](double r) {
    const double log_tail =
        freedom == known ? -0.5 * r * r : -(half + 0.5 * freedom) * std::log1p(r * r / freedom);
    return std::pow(r, dimensions - 1.0) * std::exp(log_tail - log_scale);
  };
  constexpr int steps = 4096;  // even
  const double width = radius / steps;
  double sum = density(0.0) + density(radius);
  for (int i = 1; i < steps; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * density(i * width);
  return sum * width / 3.0;
}

/// Returns the radius for which chance_within() equals `confidence`. [standard deviations]
double radius_of(double confidence, double dimensions, double freedom) {
  double low = 0.0;
  double high = 1.0;
  while (chance_within(high, dimensions, freedom) < confidence) high *= 2.0;
  while (high - low > 1e-9 * high) {
    const double middle = 0.5 * (low + high);
    (chance_within(middle, dimensions, freedom) < confidence ? low : high) = middle;
  }
  return high;
}

}  // namespace

double TargetError::rms() const noexcept { return std::sqrt(covariance.trace()); }

double TargetError::worst_deviation() const noexcept {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(solver.eigenvalues()[2], 0.0));
}

TargetError target_error(const RigidFit& fit, const Vec3& target, std::optional<double> fle) {
  if (!target.allFinite()) throw Error("target_error: the target is not finite");
  if (fle && !(*fle > 0.0 && std::isfinite(*fle))) {
    throw Error("target_error: fle must be above 0 and finite, not " + text_of(*fle) +
                "; leave it out to estimate it");
  }
  const double error = fle.value_or(fit.estimated_fle());
  constexpr double negligible = 1e-6;  // of the spread of the points
  if (!fle && error * std::sqrt(fit.looseness.trace()) < negligible) {
    throw Error(
        "the residuals are 0 to rounding, as if the points were not measured: they say nothing "
        "about the localization error; give fle");
  }
  const Vec3 p = target - fit.center;
  Mat3 turning;
  turning << 0.0, -p.z(), p.y(), p.z(), 0.0, -p.x(), -p.y(), p.x(), 0.0;
  const auto count = static_cast<double>(fit.residuals.size());
  return {error * error / 3.0 *
          (Mat3::Identity() / count + turning * fit.looseness * turning.transpose())};
}

double registration_margin(const RigidFit& fit, std::span<const Vec3> targets, double confidence,
                           std::optional<double> fle) {
  if (targets.empty()) {
    throw Error("registration_margin: no targets; say where in the mesh the tool works");
  }
  if (!(confidence > 0.0 && confidence <= 0.9999)) {
    throw Error("registration_margin: the confidence must be above 0 and at most 0.9999, not " +
                text_of(confidence));
  }
  double deviation = 0.0;
  for (const Vec3& target : targets) {
    deviation = std::max(deviation, target_error(fit, target, fle).worst_deviation());
  }
  const double freedom = fle ? known : 3.0 * static_cast<double>(fit.residuals.size()) - 6.0;
  return deviation * radius_of(confidence, targets.size() == 1 ? 3.0 : 6.0, freedom);
}

}  // namespace keepout
