// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/geometry/shapes.h"

namespace keepout::test {

/// Returns the signed distance of the hull of some points and a triangle by brute force in 64-bit
/// arithmetic: it tries every three corners of their Minkowski difference, as a face that parts the
/// two and as a triangle with the nearest point. Shares no code with the engine.
double reference_separation(std::span<const Vec3> points, const Triangle& triangle);

}  // namespace keepout::test
