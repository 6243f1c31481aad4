// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/robot/chain.h"
#include "keepout/step/guide.h"

namespace keepout {

/// Returns the point that has to stay in the guide's region. [length; of an axis, a unit vector]
Vec3 guided_point(const Guide& guide, const ChainState& state) noexcept;

/// Returns where the guided point is on a shaft, as a fraction of the way between its points; 0 for
/// other guides.
double guided_fraction(const Guide& guide, const ChainState& state) noexcept;

/// Returns the derivative of the guided point with respect to joint k, at a fixed fraction of the
/// shaft. [1 / unit of the joint]
Vec3 guided_derivative(const Guide& guide, const ChainState& state, int k) noexcept;

/// Returns a bound of the guided point's second derivative by the fraction of the motion, while the
/// joints move by `increment` (n) on a straight line from `state`. `slide`: bound of the derivative
/// of the shaft's fraction.
double guided_bend(const Guide& guide, const ChainState& state, std::span<const double> increment,
                   double slide) noexcept;

}  // namespace keepout
