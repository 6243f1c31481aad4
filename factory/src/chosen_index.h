// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Who is told of what does no harm but should be known; may be empty.
using Warn = std::function<void(const std::string&)>;

/// The index of that name, from the folder `cache` where it is kept there. Throws Error for a name
/// that does not exist.
std::shared_ptr<const SpatialIndex> make_or_load_index(std::shared_ptr<const Mesh> mesh,
                                                       const std::string& name,
                                                       const std::filesystem::path& cache,
                                                       const Warn& warn);

/// Where the rounding of the index's floats is no longer small beside the distance kept, it clears
/// little, and most triangles in reach are asked about in double. `kept`: from the mesh to a tip,
/// or to the core of the thinnest body. [length]
void warn_of_coarse_index(const SpatialIndex& index, double kept, const Warn& warn);

}  // namespace keepout
