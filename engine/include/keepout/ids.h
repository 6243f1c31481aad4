// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>

namespace keepout {

using VertexId = std::uint32_t;    // a vertex of a mesh, from 0
using TriangleId = std::uint32_t;  // a triangle of a mesh, from 0

/// The value for "no triangle", for example across a boundary edge.
inline constexpr TriangleId no_triangle = std::numeric_limits<TriangleId>::max();

}  // namespace keepout
