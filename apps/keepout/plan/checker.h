// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace keepout::app {

/// How a planner learns whether a motion is valid.
struct Checker {
  enum class Kind : std::uint8_t {
    sampled,    // OMPL's own: places along the motion, each by its exact distance from the mesh
    widened,    // the same with half the way between places added to the clearance: a proof, too
    certified,  // keepout's motion validator: the whole of it is proven
    sliding     // keepout's projecting steer, in a planner of its own with two trees
  };
  Kind kind = Kind::certified;
  double resolution = 0.0;  // if sampled: between places, in shares of the space's extent

  /// "sampled 1 %", "widened 1 %", "certified", "sliding".
  std::string name() const;
  /// Whether keepout answers for its paths.
  bool is_keepouts() const noexcept { return kind == Kind::certified || kind == Kind::sliding; }
};

/// Sampled at each resolution, the same widened, then both of keepout's.
std::vector<Checker> checkers(std::span<const double> resolutions);

}  // namespace keepout::app
