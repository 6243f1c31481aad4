// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "keepout/geometry/pose.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

/// A quaternion as messages have it. Named, for the order of its parts differs from one library to
/// the next.
struct Quaternion {
  double x = 0.0;  // along the first axis
  double y = 0.0;  // along the second
  double z = 0.0;  // along the third
  double w = 1.0;  // the scalar part
};

/// How far a matrix may be from a rotation, in each element of R^T R: matrices are passed on with
/// four digits, and a scale of 1.0001 is 0.02 mm in 200 mm.
inline constexpr double rotation_tolerance = 1e-4;

/// Whether a matrix is a rotation, to within the tolerance: finite, orthonormal, no reflection.
bool is_rotation(const Mat3& matrix) noexcept;

/// The rotation nearest to what is one to within the tolerance. Precondition: is_rotation(matrix).
Mat3 nearest_rotation(const Mat3& matrix) noexcept;

/// Whether a pose may be acted upon: its position is finite and its rotation is one.
bool is_valid(const Pose& pose) noexcept;

/// The rotation of a quaternion, which is normalized. Nothing when it is not finite, or when its
/// length is off 1 by more than the tolerance: an empty message has zeros.
std::optional<Mat3> to_rotation(const Quaternion& quaternion) noexcept;

/// The quaternion of a rotation, w >= 0. Precondition: is_rotation(rotation).
Quaternion to_quaternion(const Mat3& rotation) noexcept;

/// What lengths are measured in. There is no default: whoever forgets is told.
enum class LengthUnit : std::uint8_t { unstated, millimetre, metre };

/// The unit of each side of a registration. CRTK and ROS speak meters; meshes are in millimeters.
struct RegistrationUnits {
  LengthUnit transform = LengthUnit::unstated;  // of the matrix's translation
  LengthUnit robot = LengthUnit::unstated;      // of the robot's poses
  LengthUnit mesh = LengthUnit::unstated;       // of the mesh, and of all that keepout is given
};

/// Where the mesh is in the robot's frame, and what both measure lengths in. The robot's frame is
/// the one that its poses are in: its base, or the camera (docs/controllers.md). The mesh stays
/// where it is: poses are brought into its frame, and motions and forces back out.
///
/// Forces are in newtons on both sides: they are turned, and nothing else.
class Registration {
 public:
  /// From the 4 x 4 matrix that takes points of the robot's frame to the frame of the mesh. Throws
  /// Error for a matrix that is no rotation and translation, saying which of a reflection, a scale
  /// or a shear it is; for a translation of more than 10 m; for a unit left unstated. What is a
  /// rotation to within rotation_tolerance is taken for the nearest one.
  static Registration mesh_from_robot(const Eigen::Matrix4d& matrix,
                                      const RegistrationUnits& units);

  /// The same from its inverse: where the mesh's origin and axes are in the robot's frame.
  static Registration robot_from_mesh(const Eigen::Matrix4d& matrix,
                                      const RegistrationUnits& units);

  /// A point of the robot's frame, in the frame and the unit of the mesh; and back.
  Vec3 point_to_mesh(const Vec3& point) const noexcept {
    return rotation_ * (scale_ * point) + translation_;
  }
  /// The inverse of point_to_mesh.
  Vec3 point_to_robot(const Vec3& point) const noexcept {
    return (rotation_.transpose() * (point - translation_)) / scale_;
  }

  /// A displacement or a velocity; and back.
  Vec3 vector_to_mesh(const Vec3& vector) const noexcept { return rotation_ * (scale_ * vector); }
  /// The inverse of vector_to_mesh.
  Vec3 vector_to_robot(const Vec3& vector) const noexcept {
    return (rotation_.transpose() * vector) / scale_;
  }

  /// A force, [N] on both sides; and back.
  Vec3 force_to_mesh(const Vec3& force) const noexcept { return rotation_ * force; }
  /// The inverse of force_to_mesh.
  Vec3 force_to_robot(const Vec3& force) const noexcept { return rotation_.transpose() * force; }

  /// How many of the mesh's units one of the robot's is: 1000 for meters and millimeters.
  double scale() const noexcept { return scale_; }

 private:
  Registration(const Mat3& rotation, const Vec3& translation, double scale) noexcept
      : rotation_(rotation), translation_(translation), scale_(scale) {}

  Mat3 rotation_;     // from the robot's axes to those of the mesh
  Vec3 translation_;  // the robot's origin [length]
  double scale_;      // [length / unit of the robot]
};

}  // namespace keepout
