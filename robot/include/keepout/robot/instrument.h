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

/// A part of an instrument that shall keep clear: all within `radius` of the convex hull of its
/// points. One point is a ball, two are a capsule, more are a blade. The points of a capsule may be
/// on different links: a shaft from its port to its wrist.
struct Body {
  std::string name = {};               // for messages and records
  std::vector<LinkPoint> points = {};  // of the core, 1 to 8
  double radius = 0.0;                 // [length], >= 0
};

/// A chain, and what it carries.
class Instrument {
 public:
  static constexpr std::size_t most_bodies = 16;           // of an instrument
  static constexpr std::size_t most_points = 48;           // of all bodies, equal ones counted once
  static constexpr std::size_t most_points_of_a_body = 8;  // of its core

  /// Throws Error, naming the body, for none or more than most_bodies, a body without points or
  /// with too many, three points or more that are not all on one link, a link that does not exist,
  /// a number that is not finite, or a negative radius.
  Instrument(Chain chain, std::vector<Body> bodies);

  /// What carries the bodies.
  const Chain& chain() const noexcept { return chain_; }
  /// What is carried, as it was given.
  std::span<const Body> bodies() const noexcept { return bodies_; }

  /// All points, those that bodies share once. A body names its own by their place in here.
  std::span<const LinkPoint> points() const noexcept { return points_; }
  /// The points of body b, by their number.
  std::span<const std::uint8_t> points_of(std::size_t b) const noexcept {
    return {numbers_[b].data(), bodies_[b].points.size()};
  }

 private:
  Chain chain_;
  std::vector<Body> bodies_;
  std::vector<LinkPoint> points_;
  std::vector<std::array<std::uint8_t, most_points_of_a_body>> numbers_;
};

/// The ball of a tool's tip on three joints that slide along the axes of the world, without limits:
/// q is where its center is. So a tip has what instruments have, several meshes that move, and
/// guides; beside one mesh that stands still MotionConstraint is several times faster. [length]
Instrument free_ball(double radius);

}  // namespace keepout
