// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Bullet counts the nodes, of which it reserves twice as many as there are triangles, by an int.
inline constexpr std::size_t bullet_most_triangles = (std::size_t{1} << 30) - 1;

/// While it builds, Bullet counts the bytes of a quantised tree, 16 a node, by an int. The 21 bits
/// that it has for the number of a triangle are no limit: the mesh is handed over in parts.
inline constexpr std::size_t bullet_quantized_most_triangles = std::size_t{1} << 26;

/// Bullet's tree of axis-aligned boxes, in double.
std::unique_ptr<SpatialIndex> make_bullet_index(std::shared_ptr<const Mesh> mesh);

/// The same, the coordinates of the boxes quantised to 16 bits, outwards.
std::unique_ptr<SpatialIndex> make_bullet_quantized_index(std::shared_ptr<const Mesh> mesh);

/// The quantised tree, walked by Bullet itself, which calls back for each triangle whose box
/// touches the ball's.
std::unique_ptr<SpatialIndex> make_bullet_callback_index(std::shared_ptr<const Mesh> mesh);

std::string bullet_library();

}  // namespace keepout
