// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ball_screen.h"

namespace keepout {

/// A ball as floats see it beside oriented boxes (PdNode).
///
/// The place of the centre c in a box's frame is off by at most 8 u |c - center| + A, with u and A
/// of ball_screen.cpp: two roundings of the difference, four of the products and their sum. Where a
/// triangle in the box is as near as the radius r, |c - center| is at most r plus half the box's
/// diagonal; the box was enlarged for the latter's share. The frame stretches lengths by at most
/// 4 u, and squares and their sum round by 5 u.
struct OrientedScreen {
  explicit OrientedScreen(const BallScreen& ball) noexcept;

  float high_part[3];  // of the centre, and what is left of it; the sum of both is meant [length]
  float low_part[3];
  float reach2;   // a box is out of reach if its squared distance computes to more
  float inside2;  // all that is in a box touches the ball if its farthest corner's does not
};

}  // namespace keepout
