// SPDX-License-Identifier: BSD-3-Clause
#include "median_split.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

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

Spread spread_of(std::span<const Center> centers) noexcept {
  const std::array<float, 3> from = centers.front().position;
  double x = 0, y = 0, z = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  for (const Center& center : centers) {
    const double dx = static_cast<double>(center.position[0]) - static_cast<double>(from[0]);
    const double dy = static_cast<double>(center.position[1]) - static_cast<double>(from[1]);
    const double dz = static_cast<double>(center.position[2]) - static_cast<double>(from[2]);
    x += dx;
    y += dy;
    z += dz;
    xx += dx * dx;
    xy += dx * dy;
    xz += dx * dz;
    yy += dy * dy;
    yz += dy * dz;
    zz += dz * dz;
  }
  const auto count = static_cast<double>(centers.size());
  const Vec3 mean = Vec3(x, y, z) / count;
  Eigen::Matrix3d about_first;
  about_first << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return {mean + Vec3(static_cast<double>(from[0]), static_cast<double>(from[1]),
                      static_cast<double>(from[2])),
          about_first - count * mean * mean.transpose()};
}

Eigen::Matrix3d principal_axes(const Eigen::Matrix3d& covariance) noexcept {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  if (!solver.eigenvectors().allFinite()) return axes;
  const Vec3 first = solver.eigenvectors().col(2).normalized();
  if (!(std::abs(first.squaredNorm() - 1.0) < 1e-6)) return axes;
  Vec3 second = first.cross(solver.eigenvectors().col(1)).cross(first).normalized();
  if (!(std::abs(second.squaredNorm() - 1.0) < 1e-6)) second = first.unitOrthogonal();
  axes.row(0) = first;
  axes.row(1) = second;
  axes.row(2) = first.cross(second);
  return axes;
}

}  // namespace keepout
