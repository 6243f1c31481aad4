// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "keepout/index/wide_bvh.h"
#include "keepout/mesh/mesh.h"

namespace keepout::app {

/// A mesh to measure on, and our index over it.
struct IndexedMesh {
  std::shared_ptr<const Mesh> mesh;
  std::unique_ptr<const WideBvh> index;
};

IndexedMesh with_index(std::shared_ptr<const Mesh> mesh);

/// The same surface with coordinates as an STL file holds them.
Surface in_single_precision(Surface surface);

/// The bunny, 150 mm large, with so many triangles (or up to three fewer), as an STL file holds it.
/// Throws Error where the fixture has not been prepared.
std::shared_ptr<const Mesh> bunny_of(std::size_t triangles);

/// The file of a bunny that is large: made once, and kept beside the fixtures. Throws Error.
std::filesystem::path large_bunny(std::size_t triangles);

}  // namespace keepout::app
