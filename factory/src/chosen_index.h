// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Receives warnings that do no harm; may be empty.
using Warn = std::function<void(const std::string&)>;

/// Returns the index with a name, from the directory `cache` if it is stored there. Throws Error
/// for an unknown name.
std::shared_ptr<const SpatialIndex> make_or_load_index(std::shared_ptr<const Mesh> mesh,
                                                       const std::string& name,
                                                       const std::filesystem::path& cache,
                                                       const Warn& warn);

/// Warns if the rounding of the index's floats is large beside the distance kept. The index then
/// clears few triangles, and most of those in reach need double precision. `kept`: from the mesh to
/// a tip, or to the core of the thinnest body. [length]
void warn_of_coarse_index(const SpatialIndex& index, double kept, const Warn& warn);

}  // namespace keepout
