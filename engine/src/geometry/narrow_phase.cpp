// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/narrow_phase.h"

namespace keepout {

bool is_in_range(const Vec3& position, const Triangle& triangle) noexcept {
  const auto within = [](const Vec3& v) { return (v.array().abs() <= 1e30).all(); };
  return within(position) && within(triangle[0]) && within(triangle[1]) && within(triangle[2]);
}

NarrowPhaseAnswer ExactNarrowPhase::separation(const Vec3& position,
                                               const Triangle& triangle) noexcept {
  return {keepout::separation(tool_, position, triangle), {}};
}

}  // namespace keepout
