// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/shapes.h"

namespace keepout {

/// A displacement of a frame in one cycle (InstrumentConstraint::step), or its velocity
/// (InstrumentConstraint::place: per second). In the axes of the world, which are those of the
/// first mesh unless `place` moves it.
struct Twist {
  Vec3 linear = Vec3::Zero();   // of the frame's origin [length]
  Vec3 angular = Vec3::Zero();  // rotation: axis times angle [rad]
};

}  // namespace keepout
