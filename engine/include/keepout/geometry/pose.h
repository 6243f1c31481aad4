// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/shapes.h"

namespace keepout {

/// A rotation matrix, of a type whose alignment does not depend on compiler flags.
using Mat3 = Eigen::Matrix3d;

/// The position and the orientation of a frame in a parent frame.
struct Pose {
  Vec3 position = Vec3::Zero();      // of the frame's origin, in the unit of the parent frame
  Mat3 rotation = Mat3::Identity();  // from the frame's axes to those of the parent frame

  /// Returns the position of a point of the frame in the parent frame. [length]
  Vec3 operator*(const Vec3& point) const noexcept { return position + rotation * point; }
  /// Returns the pose in the parent frame of a pose that is given in this frame.
  Pose operator*(const Pose& inner) const noexcept {
    return {*this * inner.position, rotation * inner.rotation};
  }
};

/// A point that a link of a chain carries.
struct LinkPoint {
  int link = 0;                  // 0 is the base, which does not move
  Vec3 position = Vec3::Zero();  // in the frame of the link [length]
};

}  // namespace keepout
