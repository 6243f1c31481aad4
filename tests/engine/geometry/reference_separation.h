// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/geometry/shapes.h"

namespace keepout::test {

/// Returns the signed distance between the hull of some points and a triangle, by brute force in
/// long double. Each triple of corners of the Minkowski difference is tried as a separating face,
/// and as the triangle with the nearest point. Shares no code with the engine.
double reference_separation(std::span<const Vec3> points, const Triangle& triangle);

}  // namespace keepout::test
