// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

// Meshes that constraints and indices share, and places near them.

inline std::shared_ptr<const Mesh> mesh_of(Surface surface) {
  return std::make_shared<const Mesh>(std::move(surface));
}

/// Returns the generated shape of this name.
inline std::shared_ptr<const Mesh> mesh_of(std::string_view shape) {
  return mesh_of(make_shape(shape));
}

// More query points, in addition to those of keepout/fixtures/poses.h. "Size" is the diagonal of
// the mesh's bounds.

/// Returns points distributed evenly in the mesh's bounds, enlarged by a quarter size on all sides.
inline std::vector<Vec3> random_points(const Mesh& mesh, std::size_t count, Random& random) {
  const Vec3 border = Vec3::Constant(0.25 * mesh.bounds().size().norm());
  const Vec3 low = mesh.bounds().low - border;
  const Vec3 high = mesh.bounds().high + border;
  std::vector<Vec3> points(count);
  for (Vec3& p : points) {
    for (int axis = 0; axis < 3; ++axis) p[axis] = random.uniform(low[axis], high[axis]);
  }
  return points;
}

/// Returns points in random directions, 1 to 1e4 sizes from the center of the bounds, as many in
/// each decade. The last bit depends on the system's pow.
inline std::vector<Vec3> far_points(const Mesh& mesh, std::size_t count, Random& random) {
  const double size = mesh.bounds().size().norm();
  std::vector<Vec3> points(count);
  for (Vec3& p : points) {
    const Vec3 direction = random.direction();
    p = mesh.bounds().center() + size * std::pow(10, random.uniform(0, 4)) * direction;
  }
  return points;
}

}  // namespace keepout
