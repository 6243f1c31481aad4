// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/shapes.h"

namespace keepout {

/// A displacement of a frame in one cycle, or a velocity of a frame. InstrumentConstraint::step
/// takes a displacement, and InstrumentConstraint::place takes a velocity, with units per second.
/// Both are in the axes of the world. Meshes that `place` has not moved have the same axes.
struct Twist {
  Vec3 linear = Vec3::Zero();   // of the frame's origin [length]
  Vec3 angular = Vec3::Zero();  // rotation: axis times angle [rad]
};

}  // namespace keepout
