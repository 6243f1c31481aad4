// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "keepout/geometry/shapes.h"
#include "triangle_blocks.h"

namespace keepout {

/// A ball as floats see it, with bounds so drawn that what a float says of a box or a triangle
/// beyond them is what the exact kernel says. How they are drawn: ball_screen.cpp.
struct BallScreen {
  /// Of a mesh within `bounds`, whose floats are in `frame`.
  BallScreen(const Ball& ball, const Box& bounds, const LeafFrame& frame) noexcept;

  /// False where a float would overflow: then nothing else here is to be used.
  bool fits;

  Ball ball;
  double off;          // how far all corners may be moved, as floats see them [length]
  double pad;          // how far the exact kernel may be off [length]
  float high_part[3];  // of the center in the frame: the floats nearest to its coordinates [length]
  float low_part[3];   // and to what they leave of them [length]
  float below[3];      // floats around the center [length]
  float above[3];

  float box_reach2;   // a box is out of reach if its squared distance computes to more
  float box_inside2;  // all that is in a box touches the ball if its farthest corner's does not
  float inside2;      // the square of the radius by which triangles are surely in [length^2]
  float outside2;     // and of that by which they are surely out [length^2]

  /// The share of |farthest corner|^2 + radius^2 by which squared distances may be off.
  static constexpr float band = 0x1p-19f;

  /// Squares of lengths below lose digits, or all of themselves.
  static constexpr float least2 = 1e-36f;
};

/// A float below x and one above it, by a few units in the last place and by what underflow may
/// cost. Not a number where x is beyond the range of a float, which then proves nothing.
inline float at_most(double x) noexcept {
  const auto f = static_cast<float>(x);
  return f - std::abs(f) * 0x1p-21f - BallScreen::least2;
}
inline float at_least(double x) noexcept { return -at_most(-x); }

}  // namespace keepout
