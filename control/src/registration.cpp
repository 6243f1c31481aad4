// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/registration.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>
#include <cstdio>
#include <string>

#include "keepout/error.h"

namespace keepout {
namespace {

constexpr double longest_translation = 10'000.0;  // [mm]

double millimetres(LengthUnit unit, const char* whose) {
  switch (unit) {
    case LengthUnit::millimetre:
      return 1.0;
    case LengthUnit::metre:
      return 1000.0;
    case LengthUnit::unstated:
      break;
  }
  throw Error(std::string("registration: say the unit of ") + whose +
              ": LengthUnit::millimeter or LengthUnit::meter");
}

std::string text_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.7g", value);
  return text;
}

/// Throws Error, which states why the matrix is not a rotation.
[[noreturn]] void refuse(const Mat3& matrix) {
  const Vec3 scales = Eigen::JacobiSVD<Mat3>(matrix).singularValues();  // the largest first
  const std::string start = "registration: the matrix is not a rotation: ";
  if (scales[0] == 0.0) throw Error(start + "it is all zeros; has it been filled in?");
  if (scales[2] < 1e-3 * scales[0]) {
    throw Error(start + "it flattens space; check its nine elements");
  }
  // Both errors may be below the tolerance, and only their sum above it. The message names the
  // larger one.
  const double spread = scales[0] - scales[2];
  const double off = std::abs(scales[0] - 1.0);
  const bool is_rigid = spread <= rotation_tolerance * scales[0] && off <= rotation_tolerance;
  if (is_rigid && matrix.determinant() < 0.0) {
    throw Error(start +
                "it is a reflection; an axis has the wrong sign, or the frame is left-handed. From "
                "LPS to RAS two axes change signs, not one");
  }
  if (spread > (is_rigid ? 0.5 * off : rotation_tolerance * scales[0])) {
    throw Error(start + "it stretches by " + text_of(scales[0]) + " one way and by " +
                text_of(scales[2]) +
                " another; register rigidly, without scale or shear, and write four digits or "
                "more");
  }
  throw Error(start + "it scales by " + text_of(scales[0]) +
              "; remove the scale from it: RegistrationUnits states which lengths are meters and "
              "which are millimeters");
}

Mat3 rotation_of(const Mat3& matrix) {
  if (!is_rotation(matrix)) refuse(matrix);
  return nearest_rotation(matrix);
}

void check_matrix(const Eigen::Matrix4d& matrix) {
  if (!matrix.allFinite()) {
    throw Error("registration: the matrix has an element that is not finite");
  }
  const Eigen::RowVector4d last(0.0, 0.0, 0.0, 1.0);
  if ((matrix.row(3) - last).cwiseAbs().maxCoeff() > 1e-9) {
    throw Error(
        "registration: the last row of the matrix must be 0 0 0 1; is it transposed, with its "
        "translation there?");
  }
}

}  // namespace

bool is_rotation(const Mat3& matrix) noexcept {
  if (!matrix.allFinite()) return false;
  const Mat3 off = matrix.transpose() * matrix - Mat3::Identity();
  // The product of a finite matrix may overflow, so allFinite() rejects NaN.
  return off.cwiseAbs().maxCoeff() <= rotation_tolerance && off.allFinite() &&
         matrix.determinant() > 0.0;
}

Mat3 nearest_rotation(const Mat3& matrix) noexcept {
  const Eigen::JacobiSVD<Mat3> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

bool is_valid(const Pose& pose) noexcept {
  return pose.position.allFinite() && is_rotation(pose.rotation);
}

std::optional<Mat3> to_rotation(const Quaternion& quaternion) noexcept {
  const double x = quaternion.x, y = quaternion.y, z = quaternion.z, w = quaternion.w;
  const double length = std::sqrt(x * x + y * y + z * z + w * w);
  if (!(std::abs(length - 1.0) <= rotation_tolerance)) return std::nullopt;
  return Eigen::Quaterniond(w / length, x / length, y / length, z / length).toRotationMatrix();
}

Quaternion to_quaternion(const Mat3& rotation) noexcept {
  const Eigen::Quaterniond q(rotation);
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const double scale = sign / q.norm();
  return {scale * q.x(), scale * q.y(), scale * q.z(), scale * q.w()};
}

Registration Registration::mesh_from_robot(const Eigen::Matrix4d& matrix,
                                           const RegistrationUnits& units) {
  const double transform = millimetres(units.transform, "the matrix's translation");
  const double robot = millimetres(units.robot, "the robot's poses");
  const double mesh = millimetres(units.mesh, "the mesh");
  check_matrix(matrix);
  const Mat3 rotation = rotation_of(matrix.topLeftCorner<3, 3>());
  const Vec3 translation = matrix.topRightCorner<3, 1>();
  if (translation.norm() * transform > longest_translation) {
    throw Error("registration: the translation is " +
                text_of(translation.norm() * transform / 1000.0) +
                " m long, and no robot is so far from what it works on; is its unit " +
                (units.transform == LengthUnit::metre ? "millimeters?" : "micrometers?"));
  }
  return {rotation, translation * (transform / mesh), robot / mesh, units.mesh};
}

Registration Registration::robot_from_mesh(const Eigen::Matrix4d& matrix,
                                           const RegistrationUnits& units) {
  check_matrix(matrix);
  const Mat3 rotation = rotation_of(matrix.topLeftCorner<3, 3>());
  Eigen::Matrix4d inverse = Eigen::Matrix4d::Identity();
  inverse.topLeftCorner<3, 3>() = rotation.transpose();
  inverse.topRightCorner<3, 1>() = -(rotation.transpose() * matrix.topRightCorner<3, 1>());
  return mesh_from_robot(inverse, units);
}

}  // namespace keepout
