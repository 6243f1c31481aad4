// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/robot/chain.h"
#include "keepout/step/guide.h"

namespace keepout {

/// Returns the point that must stay in the guide's region. [length; of an axis, a unit vector]
Vec3 guided_point(const Guide& guide, const ChainState& state) noexcept;

/// Returns the position of the guided point on a shaft, as a fraction of the segment between the
/// shaft's two points. Returns 0 for other guides.
double guided_fraction(const Guide& guide, const ChainState& state) noexcept;

/// Returns the derivative of the guided point with respect to joint k, at a fixed fraction of the
/// shaft. [1 / unit of the joint]
Vec3 guided_derivative(const Guide& guide, const ChainState& state, int k) noexcept;

/// Returns a bound of the guided point's second derivative with respect to the fraction of the
/// motion, while the joints move by `increment` (n) on a straight line from `state`. `slide`: a
/// bound of the derivative of guided_fraction().
double guided_bend(const Guide& guide, const ChainState& state, std::span<const double> increment,
                   double slide) noexcept;

}  // namespace keepout
