// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "oriented_screen.h"

#include <algorithm>

namespace keepout {

OrientedScreen::OrientedScreen(const BallScreen& ball) noexcept {
  constexpr double band = 0x1p-17;
  std::copy_n(ball.high_part, 3, high_part);
  std::copy_n(ball.low_part, 3, low_part);
  const double off = 2.0 * (ball.off + ball.pad);
  const double reach = std::max(ball.ball.radius, 0.0) + off;
  const double core = ball.ball.radius - off;
  reach2 = at_least(reach * reach * (1.0 + band));
  inside2 = core > 0.0 ? at_most(core * core * (1.0 - band)) : -1.0f;
}

}  // namespace keepout
