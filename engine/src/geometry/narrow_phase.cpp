// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/narrow_phase.h"

namespace keepout {

NarrowPhaseAnswer ExactNarrowPhase::separation(const Vec3& position,
                                               const Triangle& triangle) noexcept {
  return {keepout::separation(tool_, position, triangle), {}};
}

}  // namespace keepout
