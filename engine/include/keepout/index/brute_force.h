// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Tests every triangle with the exact kernel: the oracle for all other indices.
class BruteForce final : public SpatialIndex {
 public:
  /// Stores the mesh, in O(1).
  explicit BruteForce(std::shared_ptr<const Mesh> mesh);

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override;
  TriangleId nearest(const Vec3& point, Budget& budget) const noexcept override;
  std::size_t memory() const noexcept override { return 0; }
};

}  // namespace keepout
