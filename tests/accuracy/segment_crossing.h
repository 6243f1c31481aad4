// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/LU>

#include "keepout/mesh/mesh.h"

namespace keepout {

/// Returns true if the segment from `from` to `to` passes through the inside of a triangle. Applies
/// Cramer's rule to the parameters of segment and triangle; shares no code with the engine.
inline bool passes_through(const Triangle& triangle, const Vec3& from, const Vec3& to) {
  const Vec3 along = to - from;
  const Vec3 u = triangle[1] - triangle[0];
  const Vec3 v = triangle[2] - triangle[0];
  const Vec3 w = from - triangle[0];
  Eigen::Matrix3d columns;
  columns << u, v, -along;
  const double determinant = columns.determinant();
  if (determinant == 0.0) return false;
  const auto with = [&](int column) {
    Eigen::Matrix3d replaced = columns;
    replaced.col(column) = w;
    return replaced.determinant() / determinant;
  };
  const double a = with(0), b = with(1), s = with(2);
  // A segment that ends on the triangle only touches it.
  return a >= 0.0 && b >= 0.0 && a + b <= 1.0 && s > 0.0 && s < 1.0 - 1e-9;
}

inline bool passes_through(const Mesh& mesh, const Vec3& from, const Vec3& to) {
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    if (passes_through(mesh.triangle(t), from, to)) return true;
  }
  return false;
}

}  // namespace keepout
