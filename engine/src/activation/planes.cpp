// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/planes.h"

#include <algorithm>
#include <cmath>

namespace keepout {

bool on_positive_side(const RuleInput& input, const Hit& hit, const Vec3& normal) noexcept {
  return -normal.dot(hit.closest.offset) >= -input.rounding;
}

bool touches(const RuleInput& input, const Hit& hit) noexcept {
  return hit.closest.distance <= input.rounding;
}

Vec3 retreat_target(const RuleInput& input, const Vec3& off, double lift) noexcept {
  const double climb = std::max(off.dot(input.target), 0.0);
  Vec3 along = input.target - off.dot(input.target) * off;
  const double up = std::min(climb + lift, input.radius);
  const double room = std::sqrt(std::max(input.radius * input.radius - up * up, 0.0));
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

bool has_plane(TriangleId triangle, std::span<const HalfSpace> planes) noexcept {
  return std::any_of(planes.begin(), planes.end(),
                     [&](const HalfSpace& plane) { return plane.source == triangle; });
}

}  // namespace keepout
