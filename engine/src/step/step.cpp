// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/step.h"

#include <algorithm>
#include <cmath>

namespace keepout {
namespace {

// Squares and cubes of lengths must stay finite; the mesh keeps to the same limit.
constexpr double largest_number = 1e30;

template <class Numbers>
bool are_usable(const Numbers& numbers) noexcept {
  return (numbers.array().abs() <= largest_number).all();  // false for NaN
}

}  // namespace

Status check(const Motion& motion, const StepOptions& options) noexcept {
  const bool usable = are_usable(motion.tip) && are_usable(motion.desired) &&
                      options.radius > 0.0 && options.radius <= largest_number &&
                      options.margin >= 0.0 && options.margin <= largest_number &&
                      options.damping >= 0.0 && options.damping <= largest_number;
  if (!usable) return Status::invalid_input;
  if (const auto& j = motion.jacobian) {
    if (j->joints() < 1 || j->data() == nullptr || !are_usable(j->matrix())) {
      return Status::invalid_input;
    }
  }
  // So far from the origin that a step is lost in the digits of the tip.
  if (position_rounding(motion.tip, options) > 1e-3 * options.radius) return Status::invalid_input;
  if (!(motion.desired.norm() <= reach(options))) return Status::beyond_reach;
  return Status::free;
}

double position_rounding(const Vec3& tip, const StepOptions& options) noexcept {
  return 1e-12 * (tip.lpNorm<1>() + options.margin) + 1e-10 * options.radius;
}

bool satisfies(const Vec3& motion, std::span<const HalfSpace> planes, double rounding) noexcept {
  return std::all_of(planes.begin(), planes.end(), [&](const HalfSpace& plane) {
    return plane.normal.dot(motion) >= plane.offset - 0.5 * rounding;
  });
}

std::optional<Vec3> tip_motion(const StepProblem& problem, const Solution& solution,
                               double rounding) noexcept {
  Vec3 motion = Vec3::Zero();
  double way = 0.0;  // of the tip, were all joints to move it alike
  for (Eigen::Index c = 0; c < problem.jacobian.cols(); ++c) {
    const double u = solution.u[static_cast<std::size_t>(c)];
    motion += problem.jacobian.col(c) * u;
    way += problem.jacobian.col(c).norm() * std::abs(u);
  }
  constexpr double digits = 5e-16;  // of the sum above, relative to the way
  if (!(digits * way <= rounding)) return std::nullopt;
  return motion;
}

}  // namespace keepout
