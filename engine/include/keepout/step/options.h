// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace keepout {

/// How far around the tip triangles are looked for.
enum class Query : std::uint8_t {
  motion,  // as far as the motion asked for can lead, where the rule allows that
  sphere   // always the whole motion sphere
};

/// What stays the same from cycle to cycle.
struct StepOptions {
  double radius = 0.0;   // of the motion sphere: how far the tip may go in a cycle [length], > 0
  double margin = 0.0;   // distance to keep: tool radius and safety offset [length], >= 0
  double damping = 0.0;  // weight of |u|^2 beside the task, for Jacobians without full column rank
  double recovery = 0.05;  // how far a tip that is too close is led away in a cycle [length], >= 0
  double deepest = 10.0;   // no tip is led out from deeper inside; it is told of instead [length]
  int refinements = 3;     // how often planes are turned towards a better motion, >= 0
  int nodes = 0;           // of a branch and bound for a better motion still; 0: none, >= 0
  Query query = Query::motion;  // how far around the tip triangles are looked for
  bool searching = true;  // whether a rule may search the index by itself: the same, but faster
};

/// How far the tip may go, all told: a step clipped to the radius may be longer by its rounding.
constexpr double reach(const StepOptions& options) noexcept {
  return options.radius * (1.0 + 1e-9);
}

}  // namespace keepout
