// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// One way to find the triangles near a place.
struct IndexBackend {
  std::string_view name;
  std::string_view description;
  std::unique_ptr<SpatialIndex> (*make)(std::shared_ptr<const Mesh> mesh);
};

/// All that this build has, the oracle first.
std::span<const IndexBackend> index_backends() noexcept;

/// Builds the index of that name. Throws Error, listing the names there are, if there is none.
std::unique_ptr<SpatialIndex> make_index(std::string_view name, std::shared_ptr<const Mesh> mesh);

}  // namespace keepout
