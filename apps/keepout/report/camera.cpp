// SPDX-License-Identifier: BSD-3-Clause
#include "report/camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace keepout::app {

Camera look_from(const Vec3& toward, const Vec3& up, const Vec3& target, double view_height) {
  Camera camera;
  camera.target = target;
  camera.view_height = view_height;
  camera.toward = toward.normalized();
  Vec3 right = up.cross(camera.toward);
  if (right.norm() < 1e-6 * up.norm()) right = camera.toward.unitOrthogonal();
  camera.right = right.normalized();
  camera.up = camera.toward.cross(camera.right);
  return camera;
}

void fit(Camera& camera, ImageSize size, std::span<const Vec3> points) {
  if (points.empty()) return;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double left = infinity, right = -infinity, bottom = infinity, top = -infinity;
  for (const Vec3& point : points) {
    const Vec3 offset = point - camera.target;
    const double x = camera.right.dot(offset);
    const double y = camera.up.dot(offset);
    left = std::min(left, x);
    right = std::max(right, x);
    bottom = std::min(bottom, y);
    top = std::max(top, y);
  }
  constexpr double margin = 1.05;
  const double aspect = static_cast<double>(size.width) / static_cast<double>(size.height);
  const double height = margin * std::max(top - bottom, (right - left) / aspect);
  if (height > 0.0) camera.view_height = height;
  camera.target += 0.5 * (left + right) * camera.right + 0.5 * (bottom + top) * camera.up;
}

PicturePoint project(const Camera& camera, ImageSize size, const Vec3& point) {
  const double scale = static_cast<double>(size.height) / camera.view_height;
  const Vec3 offset = scale * (point - camera.target);
  return {0.5 * static_cast<double>(size.width) + camera.right.dot(offset),
          0.5 * static_cast<double>(size.height) - camera.up.dot(offset),
          camera.toward.dot(offset)};
}

bool shows(const Camera& camera, ImageSize size, const Vec3& point) {
  const PicturePoint p = project(camera, size, point);
  return p.x >= 0.0 && p.x <= static_cast<double>(size.width) && p.y >= 0.0 &&
         p.y <= static_cast<double>(size.height);
}

}  // namespace keepout::app
