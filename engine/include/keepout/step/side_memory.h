// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "keepout/geometry/shapes.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Remembers the straight path of each point in the last step. The step proved that these paths are
/// on the free side of a mesh. Certified motions never cross the surface. So only a point away from
/// its path must be classified again.
template <std::size_t most_points>
class SideMemory {
 public:
  /// Returns true if the last step was made for this mesh.
  bool is_of(const Mesh& mesh) const noexcept { return mesh_id_ == mesh.id(); }

  /// Returns true if a point is within `distance` of the path of its last step. [length]
  bool is_near(std::size_t point, const Vec3& position, double distance) const noexcept {
    const Path& path = paths_[point];
    const Vec3 off = position - path.end;
    if (off.norm() <= distance) return true;
    const double length2 = path.back.squaredNorm();
    if (!(length2 > 0.0)) return false;
    const double fraction = std::clamp(off.dot(path.back) / length2, 0.0, 1.0);
    return (off - fraction * path.back).norm() <= distance;
  }

  /// Records the end of a step of a point, and the vector from the end to the start. [length]
  void note(const Mesh& mesh, std::size_t point, const Vec3& end, const Vec3& back) noexcept {
    mesh_id_ = mesh.id();
    paths_[point] = {end, back};
  }

  /// Forgets all: every point must be classified again.
  void forget() noexcept { mesh_id_ = 0; }

 private:
  struct Path {
    Vec3 end = Vec3::Zero();
    Vec3 back = Vec3::Zero();
  };

  std::uint64_t mesh_id_ = 0;  // 0: no mesh
  std::array<Path, most_points> paths_ = {};
};

}  // namespace keepout
