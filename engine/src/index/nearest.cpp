// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include "keepout/index/nearest.h"

#include <algorithm>

namespace keepout {
namespace {

double distance_to(const Box& box, const Vec3& point) noexcept {
  return (point - point.cwiseMax(box.low).cwiseMin(box.high)).norm();
}

}  // namespace

NearestTriangle::NearestTriangle(const Mesh& mesh, const SpatialIndex& index)
    : mesh_(&mesh), index_(&index), candidates_(4096) {}

Hit NearestTriangle::operator()(const Vec3& point, double guess) {
  const Box& bounds = mesh_->bounds();
  const double size = bounds.size().norm() + point.cwiseAbs().maxCoeff() + bounds.low.norm();
  // No triangle is nearer than the box around them; the floor keeps the growth from starting at 0.
  const double least = distance_to(bounds, point) * (1.0 + 1e-12) + 1e-6 * size;
  for (double radius = std::max(least, guess);; radius *= 2.0) {
    candidates_.clear();
    index_->collect({point, radius}, candidates_);
    while (candidates_.overflowed()) {
      candidates_ = TriangleBuffer(2 * candidates_.capacity());
      index_->collect({point, radius}, candidates_);
    }
    Hit best{no_triangle, {}};
    for (const TriangleId t : candidates_) {
      const ClosestPoint closest = closest_point(mesh_->triangle(t), point);
      if (closest.distance > radius) continue;
      const bool nearer = best.triangle == no_triangle ||
                          closest.distance < best.closest.distance ||
                          (closest.distance == best.closest.distance && t < best.triangle);
      if (nearer) best = {t, closest};
    }
    if (best.triangle != no_triangle) return best;
  }
}

}  // namespace keepout
