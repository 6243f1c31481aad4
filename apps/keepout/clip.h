// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/vec3.h"

namespace keepout::app {

/// The increment, shortened to at most `longest`. [mm]
inline Vec3 clipped(const Vec3& increment, double longest) {
  const double length = increment.norm();
  return length > longest ? Vec3(increment * (longest / length)) : increment;
}

}  // namespace keepout::app
