// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "keepout/geometry/shapes.h"

namespace keepout {

class SpatialIndex;

/// How far around the tip triangles are looked for.
enum class Query : std::uint8_t {
  motion,  // as far as the motion asked for can lead, where the rule allows that
  sphere   // always the whole motion sphere
};

/// Of which tips a step tells how far the surface is: Step::distance.
enum class Distances : std::uint8_t {
  where_known,  // of those whose distance the rule comes by anyway: costs nothing
  always        // of all; the nearest triangle is looked for after the step, where it is not known
};

/// What stays the same from cycle to cycle. Lengths are 0 or from shortest_length to
/// longest_length, but for recovery, which may be as little as you like.
struct StepOptions {
  double radius = 0.0;  // of the motion sphere: how far the tip may go in a cycle [length], > 0
  double tool_radius = 0.0;  // of the ball around the tip that shall not touch [length], >= 0
  double margin = 0.0;       // distance to keep beyond that [length], >= 0
  /// Weight of |u|^2 beside the task, >= 0. With more than three joints, or such as move the tip
  /// alike, no increment is the best one without it, and the step is ill_posed: take some 1e-6 of a
  /// column's squared length.
  double damping = 0.0;
  /// How far a tip that is too close is led away in a cycle, >= 0; by a tolerance of the rule's at
  /// least, where it can be, so that nothing adds up. [length]
  double recovery = 0.05;
  double deepest = 10.0;  // no tip is led out from deeper inside; it is told of instead [length]
  int refinements = 3;    // how often planes are turned towards a better motion, >= 0
  int nodes = 0;          // of a branch and bound for a better motion still; 0: none, >= 0
  Query query = Query::motion;                   // how far around the tip triangles are looked for
  Distances distances = Distances::where_known;  // see Step::distance
};

/// From the tip to the surface: tool radius and margin. [length]
constexpr double required_clearance(const StepOptions& options) noexcept {
  return options.tool_radius + options.margin;
}

/// How far the tip may go, all told: a step clipped to the radius may be longer by its rounding.
constexpr double longest_motion(const StepOptions& options) noexcept {
  return options.radius * (1.0 + 1e-9);
}

/// Room for the largest step that shall be solved; a step that needs more ends with over_capacity.
struct Capacity {
  /// Candidates of one query. An index that walks along motions by itself makes no such query for
  /// the certified rule, but to place a tip.
  std::size_t triangles = std::size_t{1} << 16;
  std::size_t planes = std::size_t{1} << 14;  // that a rule may pose at the same time
  std::size_t variables = 7;                  // columns of the Jacobian, or 3 without one
  std::size_t extra_rows = 64;                // of the caller's own
  std::size_t nodes = 0;                      // of the branch and bound
  /// The work of one cycle, whatever happens in it: see Budget. What cannot be proven with it is
  /// not moved. 0: looks_of_a_walk on an index that walks along motions by itself, as wide_bvh, and
  /// looks_of_queries on others, which are asked for all that is near.
  std::size_t looks = 0;

  static constexpr std::size_t looks_of_a_walk = std::size_t{1} << 16;   // of an index that walks
  static constexpr std::size_t looks_of_queries = std::size_t{1} << 22;  // not for real time

  /// Returns `looks`, or if that is 0, the default for an index. Allocates.
  static std::size_t looks_or_default(std::size_t looks, const SpatialIndex& index);
};

}  // namespace keepout
