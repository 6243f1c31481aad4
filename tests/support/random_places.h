// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

// More places to query a mesh at, beside those of keepout/fixtures/poses.h. "Size" is the diagonal
// of the mesh's bounds.

/// Evenly in the mesh's bounds, enlarged by a quarter of its size on all six sides.
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

/// In any direction, 1 to 1e4 sizes from the centre of the bounds, each decade alike. The last bit
/// is up to the system's pow.
inline std::vector<Vec3> far_points(const Mesh& mesh, std::size_t count, Random& random) {
  const double size = mesh.bounds().size().norm();
  std::vector<Vec3> points(count);
  for (Vec3& p : points) {
    const Vec3 direction = random.direction();
    p = mesh.bounds().center() + size * std::pow(10, random.uniform(0, 4)) * direction;
  }
  return points;
}

/// Normal, mean 0 and deviation 1, by Marsaglia's polar method. The last bit is up to the system's
/// logarithm.
inline double normal(Random& random) noexcept {
  while (true) {
    const double u = random.uniform(-1, 1);
    const double v = random.uniform(-1, 1);
    const double s = u * u + v * v;
    if (s > 0 && s < 1) return u * std::sqrt(-2 * std::log(s) / s);
  }
}

}  // namespace keepout
