// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "keepout/geometry/vec3.h"

namespace keepout {

/// A rotation, as a matrix: no type of Eigen's whose alignment depends on compiler flags.
using Mat3 = Eigen::Matrix3d;

/// Where a tool is, and how it is turned: in the frame and the unit of whoever says so.
struct Pose {
  Vec3 position = Vec3::Zero();      // of the tip, in the unit of that frame
  Mat3 rotation = Mat3::Identity();  // from the tool's axes to those of that frame
};

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

/// Whether a pose may be acted upon: its position is finite and its rotation is one.
bool is_valid(const Pose& pose) noexcept;

/// The rotation of a quaternion, which is normalised. Nothing when it is not finite, or when its
/// length is off 1 by more than the tolerance: an empty message has zeros.
std::optional<Mat3> to_rotation(const Quaternion& quaternion) noexcept;

/// The quaternion of a rotation, w >= 0. Precondition: is_rotation(rotation).
Quaternion to_quaternion(const Mat3& rotation) noexcept;

}  // namespace keepout
