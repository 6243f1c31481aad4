// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/planes.h"

#include <algorithm>

namespace keepout {

HalfSpace plane_through(const Hit& hit, const Vec3& normal, double margin) noexcept {
  return {normal, normal.dot(hit.closest.offset) + margin, hit.triangle};
}

bool on_positive_side(const Surroundings& around, const Hit& hit, const Vec3& normal) noexcept {
  return -normal.dot(hit.closest.offset) >= -around.rounding;
}

bool touches(const Surroundings& around, const Hit& hit) noexcept {
  return hit.closest.distance <= around.rounding;
}

bool satisfies(const Vec3& motion, std::span<const HalfSpace> planes, double rounding) noexcept {
  return std::all_of(planes.begin(), planes.end(), [&](const HalfSpace& plane) {
    return plane.normal.dot(motion) >= plane.offset - 0.5 * rounding;
  });
}

}  // namespace keepout
