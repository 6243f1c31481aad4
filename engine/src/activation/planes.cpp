// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/planes.h"

#include <algorithm>
#include <cmath>

namespace keepout {

bool on_positive_side(const CycleProblem& problem, const Hit& hit, const Vec3& normal) noexcept {
  return -normal.dot(hit.closest.offset) >= -problem.rounding;
}

bool touches(const CycleProblem& problem, const Hit& hit) noexcept {
  return hit.closest.distance <= problem.rounding;
}

Vec3 retreat_target(const CycleProblem& problem, const Vec3& off, double lift) noexcept {
  const double climb = std::max(off.dot(problem.target), 0.0);
  Vec3 along = problem.target - off.dot(problem.target) * off;
  const double up = std::min(climb + lift, problem.radius);
  const double room = std::sqrt(std::max(problem.radius * problem.radius - up * up, 0.0));
  const double length = along.norm();
  if (length > room) along *= room / length;
  return along + up * off;
}

bool let_stand_still(HalfSpaceBuffer& planes) noexcept {
  bool changed = false;
  for (HalfSpace& plane : planes) {
    if (!(plane.offset > 0.0)) continue;
    plane.offset = 0.0;
    changed = true;
  }
  return changed;
}

bool satisfies(const Vec3& motion, std::span<const HalfSpace> planes, double rounding) noexcept {
  return std::all_of(planes.begin(), planes.end(), [&](const HalfSpace& plane) {
    return plane.normal.dot(motion) >= plane.offset - 0.5 * rounding;
  });
}

bool has_plane(TriangleId source, std::span<const HalfSpace> planes) noexcept {
  return std::any_of(planes.begin(), planes.end(),
                     [&](const HalfSpace& plane) { return plane.source == source; });
}

}  // namespace keepout
