// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/robot/chain.h"

namespace keepout {

/// What bounds the way of a point while the joints move on a straight line, q + s dq, s in [0, 1].
struct MotionBounds {
  double path = 0.0;  // its length, and the largest |dp/ds|, are no more [length]
  double bend = 0.0;  // |d^2 p / ds^2| is no more [length]
};

/// The bounds for a point that link `link` carries, which is at `at` when the chain is in `state`,
/// s = 0. `increment`: dq (n). Derivation: docs/joint-space-step.md.
MotionBounds motion_bounds(const ChainState& state, std::span<const double> increment, int link,
                           const Vec3& at) noexcept;

}  // namespace keepout
