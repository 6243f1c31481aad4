// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "median_split.h"

#include "../parallel.h"

namespace keepout {

BlockVector<Center> centers_of(const Mesh& mesh, unsigned threads) {
  BlockVector<Center> centers(mesh.triangle_count());
  const Vec3 twice_the_middle = mesh.bounds().low + mesh.bounds().high;
  share_ranges(centers.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const Triangle c = mesh.triangle(static_cast<TriangleId>(t));
      const Vec3 low = c[0].cwiseMin(c[1]).cwiseMin(c[2]);
      const Vec3 high = c[0].cwiseMax(c[1]).cwiseMax(c[2]);
      const Eigen::Vector3f position = (0.5 * (low + high - twice_the_middle)).cast<float>();
      centers[t] = {{position[0], position[1], position[2]}, static_cast<TriangleId>(t)};
    }
  });
  return centers;
}

}  // namespace keepout
