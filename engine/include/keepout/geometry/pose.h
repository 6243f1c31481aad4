// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/shapes.h"

namespace keepout {

/// A rotation, as a matrix: no type of Eigen's whose alignment depends on compiler flags.
using Mat3 = Eigen::Matrix3d;

/// Where a frame is, and how it is turned: in the frame and the unit of whoever says so.
struct Pose {
  Vec3 position = Vec3::Zero();      // of its origin, in the unit of that frame
  Mat3 rotation = Mat3::Identity();  // from its axes to those of that frame

  /// Where a point of the frame is. [length]
  Vec3 operator*(const Vec3& point) const noexcept { return position + rotation * point; }
  /// A pose that is told in this frame, as seen from where this one is told.
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
