// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <utility>

#include "keepout/adapters/index_registry.h"

namespace keepout {

/// Returns an index that shares the mesh, in the form of IndexBackend::make.
template <class Index>
std::unique_ptr<SpatialIndex> make_index_of(std::shared_ptr<const Mesh> mesh) {
  return std::make_unique<Index>(std::move(mesh));
}

/// Throws Error if `count` exceeds `most`, the capacity of the index of that name. `items`:
/// triangles or vertices.
void require_at_most(std::size_t most, std::size_t count, std::string_view items,
                     std::string_view index);

}  // namespace keepout
