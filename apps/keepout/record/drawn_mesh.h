// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "keepout/mesh/mesh.h"
#include "shared/columns.h"

namespace keepout::app {

/// A mesh as a record has it: its size, and what a page draws of it. `closely`: the part that a
/// page looks at from near, of which no detail is left out. [mm]
Json drawn_mesh(const std::string& name, const Mesh& mesh,
                const std::optional<Box>& closely = std::nullopt);

/// A surface of about `most` triangles, and those within the box, that looks like the mesh from
/// far: the vertices in each cell of a grid are put on one of them.
///
/// Source: J. Rossignac, P. Borrel, "Multi-resolution 3D approximations for rendering complex
/// scenes", 1993.
Surface coarsened(const Mesh& mesh, std::size_t most, const std::optional<Box>& closely);

}  // namespace keepout::app
