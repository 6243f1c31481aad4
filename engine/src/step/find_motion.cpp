// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/find_motion.h"

#include <algorithm>
#include <cmath>

namespace keepout {

std::optional<Vec3> tip_motion(const StepProblem& problem, const Solution& solution,
                               double rounding) noexcept {
  constexpr double digits = 5e-16;  // of the sum below, relative to the way
  if (moves_a_point(problem)) {
    const double* u = solution.u.data();
    const double way = std::abs(u[0]) + std::abs(u[1]) + std::abs(u[2]);
    if (!(digits * way <= rounding)) return std::nullopt;
    return std::optional<Vec3>(std::in_place, Eigen::Map<const Vec3>(u));
  }
  Vec3 motion = Vec3::Zero();
  double way = 0.0;  // of the tip, were all joints to move it alike
  for (Eigen::Index c = 0; c < problem.jacobian.cols(); ++c) {
    const double u = solution.u[static_cast<std::size_t>(c)];
    motion += problem.jacobian.col(c) * u;
    way += problem.jacobian.col(c).norm() * std::abs(u);
  }
  if (!(digits * way <= rounding)) return std::nullopt;
  return motion;
}

Vec3 sharpened(const Vec3& motion, const Vec3& aim, std::span<const HalfSpace> planes) noexcept {
  // Solvers differ in their last digits; alternating projections on the planes that are violated
  // settle them. Each is at most a last digit for an exact solver.
  constexpr int most_corrections = 32;
  Vec3 z = motion;
  const double digits2 = 1e-30 * aim.squaredNorm();
  for (int i = 0; i < most_corrections; ++i) {
    const HalfSpace* worst = nullptr;
    double violation = 0.0;
    for (const HalfSpace& plane : planes) {
      const double missing = plane.offset - plane.normal.dot(z);
      if (!(missing > violation)) continue;
      violation = missing;
      worst = &plane;
    }
    if (worst == nullptr || !(violation * violation > digits2)) break;
    z += violation * worst->normal;
  }
  const double along = aim.dot(z);
  const double length2 = z.squaredNorm();
  if (along < length2) z *= std::max(along, 0.0) / length2;
  return z;
}

bool allow_parts(const std::optional<ExtraRows>& rows) noexcept {
  return !rows || std::all_of(rows->bounds(), rows->bounds() + rows->count(),
                              [](double bound) { return bound <= 0.0; });
}

HalfSpace bound_of(const Vec3& motion, double longest) noexcept {
  return {-motion / motion.norm(), -longest * (1.0 - 1e-9), no_triangle};
}

}  // namespace keepout
