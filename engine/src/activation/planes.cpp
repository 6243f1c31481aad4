// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/planes.h"

namespace keepout {
namespace {

/// What a position after a step may be off by: the rounding of tip + motion, and of the solver,
/// each some 1e-16 to 1e-15 of the lengths that entered. [length]
double position_rounding(const Surroundings& around) noexcept {
  return 1e-12 * (around.tip.lpNorm<1>() + around.desired.norm() + around.margin);
}

}  // namespace

HalfSpace plane_through(const Hit& hit, const Vec3& normal, double margin) noexcept {
  return {normal, normal.dot(hit.closest.offset) + margin, hit.triangle};
}

bool on_positive_side(const Surroundings& around, const Hit& hit, const Vec3& normal) noexcept {
  return -normal.dot(hit.closest.offset) >= -position_rounding(around);
}

bool touches(const Surroundings& around, const Hit& hit) noexcept {
  return hit.closest.distance <= position_rounding(around);
}

}  // namespace keepout
