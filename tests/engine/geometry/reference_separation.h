// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/geometry/shapes.h"

namespace keepout::test {

/// The signed distance of the hull of some points and a triangle, in arithmetic of 64 bits and by
/// brute force alone: of the corners of their Minkowski difference every three are tried, as a face
/// that parts the two and as a triangle that has the nearest point. Shares nothing with the engine.
double reference_separation(std::span<const Vec3> points, const Triangle& triangle);

}  // namespace keepout::test
