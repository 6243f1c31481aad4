// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "keepout/robot/chain.h"

namespace keepout {

/// A part of an instrument that must stay clear: all points within `radius` of the convex hull of
/// its points (the core). One point makes a ball, two make a capsule, more make a blade. The points
/// of a capsule may be on different links, such as a shaft from its port to its wrist.
struct Body {
  std::string name = {};               // for messages and records
  std::vector<LinkPoint> points = {};  // of the core, 1 to 8
  double radius = 0.0;                 // [length], >= 0
};

/// A chain and the bodies that it carries.
class Instrument {
 public:
  static constexpr std::size_t most_bodies = 16;           // of an instrument
  static constexpr std::size_t most_points = 48;           // of all bodies; equal points count once
  static constexpr std::size_t most_points_of_a_body = 8;  // of its core

  /// Makes an instrument. Throws Error, which names the body, for a wrong number of points, a link
  /// that does not exist, a number that is not finite, or a negative radius. Also throws Error for
  /// a body of three points or more on different links, and unless there are 1 to most_bodies
  /// bodies.
  Instrument(Chain chain, std::vector<Body> bodies);

  /// Returns the chain.
  const Chain& chain() const noexcept { return chain_; }
  /// Returns the bodies, as given.
  std::span<const Body> bodies() const noexcept { return bodies_; }

  /// Returns the points of all bodies; a point of several bodies is listed once.
  std::span<const LinkPoint> points() const noexcept { return points_; }
  /// Returns the indices into points() of the points of body b.
  std::span<const std::uint8_t> points_of(std::size_t b) const noexcept {
    return {numbers_[b].data(), bodies_[b].points.size()};
  }

 private:
  Chain chain_;
  std::vector<Body> bodies_;
  std::vector<LinkPoint> points_;
  std::vector<std::array<std::uint8_t, most_points_of_a_body>> numbers_;
};

/// Returns an instrument with one ball, the tip, on three prismatic joints along the axes of the
/// world. The joints have no limits; q is the center of the ball. So a tip can have several moving
/// meshes, like an instrument. For one mesh that does not move, MotionConstraint is several times
/// faster. [length]
Instrument free_ball(double radius);

}  // namespace keepout
