// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "keepout/control/pose.h"

namespace keepout {

/// What lengths are measured in. There is no default: whoever forgets is told.
enum class LengthUnit : std::uint8_t { unstated, millimetre, metre };

/// The unit of each side of a registration. CRTK and ROS speak metres; meshes are in millimetres.
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

  /// How many of the mesh's units one of the robot's is: 1000 for metres and millimetres.
  double scale() const noexcept { return scale_; }

 private:
  Registration(const Mat3& rotation, const Vec3& translation, double scale) noexcept
      : rotation_(rotation), translation_(translation), scale_(scale) {}

  Mat3 rotation_;     // from the robot's axes to those of the mesh
  Vec3 translation_;  // the robot's origin [length]
  double scale_;      // [length / unit of the robot]
};

}  // namespace keepout
