// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/step.h"

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
                      are_usable(motion.jacobian.matrix()) && options.radius > 0.0 &&
                      options.radius <= largest_number && options.margin >= 0.0 &&
                      options.margin <= largest_number && options.damping >= 0.0 &&
                      options.damping <= largest_number;
  if (!usable) return Status::invalid_input;
  if (!(motion.desired.norm() <= options.radius)) return Status::beyond_reach;
  return Status::free;
}

Vec3 tip_motion(const StepProblem& problem, const Solution& solution) noexcept {
  Vec3 motion = Vec3::Zero();
  for (Eigen::Index c = 0; c < problem.jacobian.cols(); ++c) {
    motion += problem.jacobian.col(c) * solution.u[static_cast<std::size_t>(c)];
  }
  return motion;
}

}  // namespace keepout
