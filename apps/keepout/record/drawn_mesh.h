// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "keepout/mesh/mesh.h"
#include "shared/columns.h"

namespace keepout::app {

/// Returns a mesh as a record contains it: its size, and a version to draw. `closely`: the region
/// that a page magnifies, which keeps all detail. [mm]
Json drawn_mesh(const std::string& name, const Mesh& mesh,
                const std::optional<Box>& closely = std::nullopt);

/// Returns a surface of about `most` triangles, plus those in the box, that resembles the mesh from
/// afar. All vertices in a cell of a grid are merged into one of them.
///
/// Source: J. Rossignac, P. Borrel, "Multi-resolution 3D approximations for rendering complex
/// scenes", 1993.
Surface coarsened(const Mesh& mesh, std::size_t most, const std::optional<Box>& closely);

}  // namespace keepout::app
