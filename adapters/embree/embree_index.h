// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Embree numbers triangles and vertices by 32 bits, as keepout does.
inline constexpr std::size_t embree_most_triangles = no_triangle;

/// Embree's tree of axis-aligned boxes, in float.
std::unique_ptr<SpatialIndex> make_embree_index(std::shared_ptr<const Mesh> mesh);

std::string embree_library();

}  // namespace keepout
