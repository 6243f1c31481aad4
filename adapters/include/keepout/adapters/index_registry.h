// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

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

/// All that this build has, the oracle first.
Registry<IndexBackend> index_backends() noexcept;

/// Builds the index of that name. Throws Error, listing the names there are, if there is none, and
/// when it cannot hold the mesh.
std::unique_ptr<SpatialIndex> make_index(std::string_view name, std::shared_ptr<const Mesh> mesh);

}  // namespace keepout
