// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "centered_frame.h"

#include <algorithm>
#include <cmath>

namespace keepout {

CenteredFrame::CenteredFrame(const Box& bounds, double reach) noexcept {
  // Halved before they are added: the bounds may span more than a double can.
  center_ = 0.5 * bounds.low + 0.5 * bounds.high;
  const double half = (bounds.high - center_).cwiseMax(center_ - bounds.low).maxCoeff();
  int exponent = 0;  // of the power of two above half; a mesh in one point keeps its unit
  if (half > 0.0) std::frexp(half, &exponent);
  // Beyond these the scale, or its inverse, were no ordinary number.
  scale_ = reach * std::ldexp(1.0, std::clamp(-exponent, -1000, 900));
}

}  // namespace keepout
