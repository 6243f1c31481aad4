// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>

#include "corner_order.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

Vec3 unit_normal(const Triangle& triangle) noexcept {
  const CornerOrder order = corner_order(triangle);
  const Vec3& a = triangle[order.corner[0]];
  const Vec3 normal = (triangle[order.corner[1]] - a).cross(triangle[order.corner[2]] - a);
  const double length = normal.norm();
  if (!(length > 0.0)) return Vec3::Zero();
  return normal / (order.odd ? -length : length);
}

Triangle ordered_relative(const Triangle& triangle, const Vec3& tip) noexcept {
  const CornerOrder order = corner_order(triangle);
  return {triangle[order.corner[0]] - tip, triangle[order.corner[1]] - tip,
          triangle[order.corner[2]] - tip};
}

}  // namespace keepout
