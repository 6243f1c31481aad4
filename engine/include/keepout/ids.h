// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>

namespace keepout {

using VertexId = std::uint32_t;    // a vertex of a mesh, from 0
using TriangleId = std::uint32_t;  // a triangle of a mesh, from 0

/// Stands where there is no triangle: across a boundary edge, for one.
inline constexpr TriangleId no_triangle = std::numeric_limits<TriangleId>::max();

}  // namespace keepout
