// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "keepout/geometry/vec3.h"

namespace keepout {

/// The three corners of a triangle, in the order of its winding. [length]
/// Edge e runs from corner e to corner (e + 1) % 3.
using Triangle = std::array<Vec3, 3>;

/// Unit normal by the right-hand rule; zero for a triangle without an area.
Vec3 unit_normal(const Triangle& triangle) noexcept;

/// The corners of a triangle in lexicographic order, relative to the tip. Ordered before the tip is
/// taken off, whose rounding could make different coordinates equal.
Triangle ordered_relative(const Triangle& triangle, const Vec3& tip) noexcept;

}  // namespace keepout
