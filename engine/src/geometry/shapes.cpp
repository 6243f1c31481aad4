// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/shapes.h"

#include <Eigen/Geometry>

#include "corner_order.h"
#include "direction_of.h"

namespace keepout {

Vec3 unit_normal(const Triangle& triangle) noexcept {
  const CornerOrder order = corner_order(triangle);
  const Vec3& a = triangle[order.corner[0]];
  const Vec3 one = triangle[order.corner[1]] - a;
  const Vec3 other = triangle[order.corner[2]] - a;
  Vec3 cross = one.cross(other);
  if (cross.norm() < least_length_of_squares) {
    cross = at_moderate_length(one).cross(at_moderate_length(other));
  }
  return direction_of(order.odd ? Vec3(-cross) : cross);
}

Triangle ordered_relative(const Triangle& triangle, const Vec3& tip) noexcept {
  const CornerOrder order = corner_order(triangle);
  return {triangle[order.corner[0]] - tip, triangle[order.corner[1]] - tip,
          triangle[order.corner[2]] - tip};
}

}  // namespace keepout
