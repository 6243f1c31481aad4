// SPDX-License-Identifier: BSD-3-Clause

#include "keepout/index/brute_force.h"

#include <utility>

#include "keepout/geometry/closest_point.h"

namespace keepout {

BruteForce::BruteForce(std::shared_ptr<const Mesh> mesh) : SpatialIndex(std::move(mesh)) {}

void BruteForce::collect(const Ball& ball, TriangleBuffer& candidates) const noexcept {
  for (TriangleId t = 0; t < mesh().triangle_count() && !candidates.overflowed(); ++t) {
    if (closest_point(mesh().triangle(t), ball.center).distance <= ball.radius) candidates.push(t);
  }
}

TriangleId BruteForce::nearest(const Vec3& point, Budget& budget) const noexcept {
  budget.spend(mesh().triangle_count() * work::nearest_in_order);
  if (budget.is_spent()) return no_triangle;
  TriangleId best = 0;
  double least = closest_point(mesh().triangle(best), point).distance;
  for (TriangleId t = 1; t < mesh().triangle_count(); ++t) {
    const double distance = closest_point(mesh().triangle(t), point).distance;
    if (!(distance < least)) continue;
    least = distance;
    best = t;
  }
  return best;
}

}  // namespace keepout
