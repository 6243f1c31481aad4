// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "keepout/geometry/pose.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

/// A quaternion as in messages. Its parts have names, because libraries order them differently.
struct Quaternion {
  double x = 0.0;  // along x
  double y = 0.0;  // along y
  double z = 0.0;  // along z
  double w = 1.0;  // the scalar part
};

/// The largest error of a rotation matrix R, in each element of R^T R. Matrices are often given
/// with four digits; a scale of 1.0001 is an error of 0.02 mm in 200 mm.
inline constexpr double rotation_tolerance = 1e-4;

/// Returns true if a matrix is a rotation, to within the tolerance: finite, orthonormal, no
/// reflection.
bool is_rotation(const Mat3& matrix) noexcept;

/// Returns the rotation nearest to a matrix. Precondition: is_rotation(matrix).
Mat3 nearest_rotation(const Mat3& matrix) noexcept;

/// Returns true if the position of a pose is finite and its matrix is a rotation.
bool is_valid(const Pose& pose) noexcept;

/// Returns the rotation of a quaternion, after normalization. Empty if the quaternion is not
/// finite, or its length differs from 1 by more than the tolerance, as in a message of zeros.
std::optional<Mat3> to_rotation(const Quaternion& quaternion) noexcept;

/// Returns the quaternion of a rotation, w >= 0. Precondition: is_rotation(rotation).
Quaternion to_quaternion(const Mat3& rotation) noexcept;

/// A unit of length. There is no default: an unstated unit is an error.
enum class LengthUnit : std::uint8_t { unstated, millimetre, metre };

/// The units of a registration. CRTK and ROS use meters; meshes are usually in millimeters.
struct RegistrationUnits {
  LengthUnit transform = LengthUnit::unstated;  // of the matrix's translation
  LengthUnit robot = LengthUnit::unstated;      // of the robot's poses
  LengthUnit mesh = LengthUnit::unstated;       // of the mesh, and of all lengths in keepout
};

/// The transform between the robot's frame and the mesh's frame, with the units of both. The
/// robot's frame is that of its poses: its base, or the camera (docs/controllers.md). The mesh does
/// not move: poses are transformed into its frame, and motions and forces back.
///
/// Forces are in newtons on both sides: they are only rotated.
class Registration {
 public:
  /// Returns the registration of the 4 x 4 matrix that transforms points of the robot's frame into
  /// the mesh's frame. The rotation is replaced by the nearest exact one. Throws Error unless the
  /// matrix is a rotation (to within rotation_tolerance) with a translation. The message states if
  /// the matrix has a reflection, a scale or a shear. Also throws Error for a translation of more
  /// than 10 m and for an unstated unit.
  static Registration mesh_from_robot(const Eigen::Matrix4d& matrix,
                                      const RegistrationUnits& units);

  /// Like mesh_from_robot, for the inverse matrix: the pose of the mesh in the robot's frame.
  static Registration robot_from_mesh(const Eigen::Matrix4d& matrix,
                                      const RegistrationUnits& units);

  /// Transforms a point from the robot's frame and unit to those of the mesh.
  Vec3 point_to_mesh(const Vec3& point) const noexcept {
    return rotation_ * (scale_ * point) + translation_;
  }
  /// Transforms a point from the mesh's frame and unit to those of the robot.
  Vec3 point_to_robot(const Vec3& point) const noexcept {
    return (rotation_.transpose() * (point - translation_)) / scale_;
  }

  /// Transforms a displacement or a velocity to the frame and the unit of the mesh.
  Vec3 vector_to_mesh(const Vec3& vector) const noexcept { return rotation_ * (scale_ * vector); }
  /// Transforms a displacement or a velocity to the robot's frame and unit.
  Vec3 vector_to_robot(const Vec3& vector) const noexcept {
    return (rotation_.transpose() * vector) / scale_;
  }

  /// Rotates a force into the frame of the mesh. [N]
  Vec3 force_to_mesh(const Vec3& force) const noexcept { return rotation_ * force; }
  /// Rotates a force into the robot's frame. [N]
  Vec3 force_to_robot(const Vec3& force) const noexcept { return rotation_.transpose() * force; }

  /// Returns the pose of the mesh in the robot's frame, in the unit of the mesh.
  Pose mesh_in_robot() const noexcept {
    return {-(rotation_.transpose() * translation_), rotation_.transpose()};
  }

  /// Returns the robot's unit divided by the mesh's unit: 1000 for meters and millimeters.
  double scale() const noexcept { return scale_; }
  /// Returns the unit of the mesh.
  LengthUnit mesh_unit() const noexcept { return mesh_unit_; }

 private:
  Registration(const Mat3& rotation, const Vec3& translation, double scale,
               LengthUnit mesh_unit) noexcept
      : rotation_(rotation), translation_(translation), scale_(scale), mesh_unit_(mesh_unit) {}

  Mat3 rotation_;     // from the robot's axes to those of the mesh
  Vec3 translation_;  // the robot's origin [length]
  double scale_;      // [length / unit of the robot]
  LengthUnit mesh_unit_;
};

}  // namespace keepout
