// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"
#include "keepout/registry.h"

namespace keepout {

/// One way to find the triangles near a place.
struct IndexBackend {
  std::string_view name;         // to ask for it by
  std::string_view description;  // one line, for lists
  /// Throws Error when the library behind it cannot hold the mesh: no triangle is ever lost.
  std::unique_ptr<SpatialIndex> (*make)(std::shared_ptr<const Mesh> mesh);
  std::size_t most_triangles;  // what its data structure can hold, were memory no object
  std::string (*library)();    // name and version of the library behind it; null for our own
  /// Whether it takes memory while it answers. With one that does, no step is fit for real time.
  Allocation allocation = Allocation::never;
  /// What it does more or less than the others when it is timed beside them, as a sentence; empty
  /// where there is nothing to say.
  std::string_view remark = {};
};

/// Returns all indices, brute force first. Loads all modules that bring some (see
/// keepout/module.h).
Registry<IndexBackend> index_backends();

/// Returns the names of the indices that can be had. Loads no module.
std::vector<std::string> index_names();

/// Returns the index of that name on a mesh. Loads at most the module that brings it. Throws Error
/// for an unknown name, and if the index cannot hold the mesh.
std::unique_ptr<SpatialIndex> make_index(std::string_view name, std::shared_ptr<const Mesh> mesh);

}  // namespace keepout

/// The table of a module that brings indices.
extern "C" [[gnu::visibility("default")]] const std::span<const keepout::IndexBackend>
    keepout_indices;
