// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/robot/chain.h"

namespace keepout {

/// Bounds of the motion of a point while the joints move on a straight line, q + s dq, s in [0, 1].
/// They are computed joint by joint, from the point to the base (docs/joint-space-step.md, Lemma
/// 2).
struct MotionBounds {
  double path = 0.0;  // of the arc length, and of |dp/ds| [length]
  double bend = 0.0;  // of |d^2 p / ds^2| [length]

  /// Adds a prismatic joint that moves by a length. [length]
  void slide(double length) noexcept { path += length; }
  /// Adds a revolute joint that turns by an angle. `lever`: the distance of the point from its axis
  /// at the start. [length], [rad]
  void turn(double lever, double angle) noexcept {
    const double arc = (lever + path) * angle;
    bend += angle * (arc + 2.0 * path);
    path += arc;
  }
};

/// Returns the bounds for a point of link `link` that is at `at` in `state`, where s is 0.
/// `increment`: dq (n). [rad or length]
MotionBounds motion_bounds(const ChainState& state, std::span<const double> increment, int link,
                           const Vec3& at) noexcept;

}  // namespace keepout
