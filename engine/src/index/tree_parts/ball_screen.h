// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "keepout/geometry/shapes.h"
#include "triangle_blocks.h"

namespace keepout {

/// A ball in floats. Its limits are such that the exact kernel agrees with every decision that
/// floats make by them. ball_screen.cpp derives the limits.
struct BallScreen {
  /// For a mesh within `bounds`, whose floats are in `frame`.
  BallScreen(const Ball& ball, const Box& bounds, const LeafFrame& frame) noexcept;

  /// False if a float would overflow. Then no other member is valid.
  bool fits;

  Ball ball;
  double off;          // how far the error of floats may move all corners [length]
  double pad;          // the error of the exact kernel [length]
  float high_part[3];  // of the center in the frame: the floats nearest to its coordinates [length]
  float low_part[3];   // the floats nearest to the remainders [length]
  float below[3];      // floats around the center [length]
  float above[3];

  float box_reach2;   // limit of a box's squared distance, beyond which the ball does not reach it
  float box_inside2;  // limit for the farthest corner, within which all triangles in the box touch
                      // the ball
  float inside2;      // squared radius within which triangles are surely in [length^2]
  float outside2;     // squared radius beyond which triangles are surely out [length^2]

  /// The error of squared distances, as a fraction of |farthest corner|^2 + radius^2.
  static constexpr float band = 0x1p-19f;

  /// Smaller squares lose digits, or underflow.
  static constexpr float least2 = 1e-36f;
};

/// Return a float below x and one above it, by a few units in the last place and the error of
/// underflow. The result is NaN if x is beyond the range of a float, and then proves nothing.
inline float at_most(double x) noexcept {
  const auto f = static_cast<float>(x);
  return f - std::abs(f) * 0x1p-21f - BallScreen::least2;
}
inline float at_least(double x) noexcept { return -at_most(-x); }

}  // namespace keepout
