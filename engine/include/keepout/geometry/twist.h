// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/shapes.h"

namespace keepout {

/// A displacement of a frame in one cycle (InstrumentConstraint::step), or its velocity
/// (InstrumentConstraint::place: per second). In the axes of the world, which are those of the
/// first mesh unless that is placed elsewhere.
struct Twist {
  Vec3 linear = Vec3::Zero();   // of its origin [length]
  Vec3 angular = Vec3::Zero();  // its turn: axis times angle [rad]
};

}  // namespace keepout
