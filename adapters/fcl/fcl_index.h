// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// FCL counts the nodes by an int, as 2 n - 1 of n triangles, of which 2 n must not overflow.
inline constexpr std::size_t fcl_most_triangles = (std::size_t{1} << 30) - 1;

/// FCL's tree of oriented boxes (OBBRSS, of which the box is used).
std::unique_ptr<SpatialIndex> make_fcl_obbrss_index(std::shared_ptr<const Mesh> mesh);

/// FCL's tree of axis-aligned boxes.
std::unique_ptr<SpatialIndex> make_fcl_aabb_index(std::shared_ptr<const Mesh> mesh);

/// FCL's own collide() of a sphere with its tree of oriented boxes (OBB), which lists what the
/// sphere touches. Takes memory while it answers: for comparison, not for real time.
std::unique_ptr<SpatialIndex> make_fcl_collide_index(std::shared_ptr<const Mesh> mesh);

std::string fcl_library();

}  // namespace keepout
