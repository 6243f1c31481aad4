// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// CGAL counts in size_t: as many as a mesh can have.
inline constexpr std::size_t cgal_most_triangles = no_triangle;

/// CGAL's tree of axis-aligned boxes, in double.
std::unique_ptr<SpatialIndex> make_cgal_index(std::shared_ptr<const Mesh> mesh);

std::string cgal_library();

}  // namespace keepout
