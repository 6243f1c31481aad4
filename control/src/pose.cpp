// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/pose.h"

#include <Eigen/Geometry>
#include <cmath>

namespace keepout {

bool is_rotation(const Mat3& matrix) noexcept {
  if (!matrix.allFinite()) return false;
  const Mat3 off = matrix.transpose() * matrix - Mat3::Identity();
  // Of a finite matrix the product may still overflow: what is not a number is not below.
  return off.cwiseAbs().maxCoeff() <= rotation_tolerance && off.allFinite() &&
         matrix.determinant() > 0.0;
}

bool is_valid(const Pose& pose) noexcept {
  return pose.position.allFinite() && is_rotation(pose.rotation);
}

std::optional<Mat3> to_rotation(const Quaternion& quaternion) noexcept {
  const double x = quaternion.x, y = quaternion.y, z = quaternion.z, w = quaternion.w;
  const double length = std::sqrt(x * x + y * y + z * z + w * w);
  if (!(std::abs(length - 1.0) <= rotation_tolerance)) return std::nullopt;
  const Mat3 rotation =
      Eigen::Quaterniond(w / length, x / length, y / length, z / length).toRotationMatrix();
  return rotation;
}

Quaternion to_quaternion(const Mat3& rotation) noexcept {
  const Eigen::Quaterniond q(rotation);
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const double scale = sign / q.norm();
  return {scale * q.x(), scale * q.y(), scale * q.z(), scale * q.w()};
}

}  // namespace keepout
