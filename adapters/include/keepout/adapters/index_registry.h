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

/// An available type of spatial index, and the function that makes one.
struct IndexBackend {
  std::string_view name;         // for make_index
  std::string_view description;  // one line, for lists
  /// Makes an index. Throws Error if the underlying library cannot hold all triangles: an index
  /// never omits one.
  std::unique_ptr<SpatialIndex> (*make)(std::shared_ptr<const Mesh> mesh);
  std::size_t most_triangles;  // capacity of the data structure
  std::string (*library)();    // name and version of the underlying library; null for keepout's own
  /// Use of heap memory during a query. Steps on an index that allocates are not suitable for real
  /// time.
  Allocation allocation = Allocation::never;
  /// One sentence for tables that compare times: how the work of this index differs from that of
  /// others. Empty if it does not differ.
  std::string_view remark = {};
};

/// Returns all indices, brute force first. Loads all modules with indices (see keepout/module.h).
Registry<IndexBackend> index_backends();

/// Adds the indices of a plugin: a shared object that exports the table `keepout_indices` (see
/// docs/adding_a_backend.md). Returns their number, 0 without such a table. For the arguments,
/// errors and the precondition see PartTable::add in keepout/module.h. All other functions then
/// know them.
std::size_t add_index_backends(const std::string& plugin);

/// Returns the names of the available indices. Loads no module.
std::vector<std::string> index_names();

/// Returns the index of that name on a mesh. Loads no module except that of the index. Throws Error
/// for an unknown name, and if the index cannot hold the mesh.
std::unique_ptr<SpatialIndex> make_index(std::string_view name, std::shared_ptr<const Mesh> mesh);

}  // namespace keepout

/// The table of the indices of a module. Each module with indices defines it, and index_backends()
/// and make_index() read it.
extern "C" [[gnu::visibility("default")]] const std::span<const keepout::IndexBackend>
    keepout_indices;
