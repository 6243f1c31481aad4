// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/spatial_index.h"

#include "keepout/error.h"

namespace keepout {

SpatialIndex::SpatialIndex(std::shared_ptr<const Mesh> mesh) : mesh_(std::move(mesh)) {
  if (mesh_ == nullptr) throw Error("an index needs a mesh: none was given");
}

}  // namespace keepout
