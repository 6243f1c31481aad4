// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "keepout/index/budget.h"
#include "keepout/option_table.h"

namespace keepout {

class SpatialIndex;

/// The extent of the search for triangles around the tip: RuleInput::searched_region.
enum class Query : std::uint8_t {
  motion,  // the places where motions may end: ActivationRule::end_region
  sphere   // the whole motion sphere, unless its triangles exceed capacity or budget
};

/// The names of Query.
inline constexpr std::array<std::string_view, 2> query_names{"motion", "sphere"};

/// The tips whose distance a step reports: Step::distance.
enum class Distances : std::uint8_t {
  where_known,  // those whose distance the rule finds in any case, at no cost
  always        // all; a search after the step uses the remaining work units
};

/// The names of Distances.
inline constexpr std::array<std::string_view, 2> distances_names{"where_known", "always"};

/// Options of a motion constraint that stay the same from cycle to cycle. The table below has their
/// ranges.
struct StepOptions {
  double radius = 5.0;       // of the motion sphere: the longest motion in a cycle [length]
  double tool_radius = 0.0;  // of the ball around the tip that must not touch the mesh [length]
  /// Required clearance beyond the tool radius: see required_clearance. [length]
  double margin = 0.2;
  /// Weight of |u|^2 in the objective. It is needed with more than three joints, or with joints
  /// that move the tip in the same direction: without it the step is ill_posed. Use about 1e-6 of a
  /// column's squared length.
  double damping = 0.0;
  /// Longest retreat per cycle of a tip that is too close or inside. If possible, the tip retreats
  /// by at least a tolerance of the rule, so that rounding does not accumulate. [length]
  double recovery = 0.05;
  double deepest = 10.0;  // a tip deeper inside does not escape; the step is `inside` [length]
  int refinements = 3;    // the most re-linearizations of a cycle
  int nodes = 0;          // of a branch and bound search; 0: no search
  Query query = Query::motion;                   // the region that is searched
  Distances distances = Distances::where_known;  // see Step::distance
};

/// The table of these options.
inline constexpr std::array step_options{
    option<&StepOptions::radius>("radius", "length", positive_length,
                                 "Radius of the motion sphere: the longest motion in a cycle."),
    option<&StepOptions::tool_radius>("tool_radius", "length", zero_or_length,
                                      "Radius of the ball around the tip that must not touch."),
    option<&StepOptions::margin>(
        "margin", "length", zero_or_length,
        "Clearance beyond the tool; the certified rule needs tool_radius + margin above 0."),
    option<&StepOptions::damping>(
        "damping", "", {0.0, 1e30},
        "Weight of |u|^2 in the objective; a Jacobian with more than three columns needs it, about "
        "1e-6 of the squared norm of a column."),
    option<&StepOptions::recovery>("recovery", "length", not_negative,
                                   "Longest retreat in a cycle of a tip too close or inside."),
    option<&StepOptions::deepest>("deepest", "length", zero_or_length,
                                  "A tip deeper inside than this does not escape."),
    option<&StepOptions::refinements>("refinements", "", {0, 1000},
                                      "Most re-linearizations of the planes for a better motion.",
                                      "refine"),
    option<&StepOptions::nodes>("nodes", "", {0, 1 << 16},
                                "Nodes of a branch-and-bound search for a better motion; 0: no "
                                "search, 16 find nearly the best.",
                                "branches"),
    option<&StepOptions::query, query_names>(
        "query",
        "Region that the certified rule searches: the possible ends of the motion, or the whole "
        "motion sphere."),
    option<&StepOptions::distances, distances_names>(
        "distances", "Tips whose distance a step reports: those where it costs nothing, or all.")};

/// Returns the table of the options of a struct.
constexpr const auto& table_of(const StepOptions&) { return step_options; }

/// Returns the required clearance of the tip from the surface: tool radius + margin. The certified
/// rule needs it above 0. [length]
constexpr double required_clearance(const StepOptions& options) noexcept {
  return options.tool_radius + options.margin;
}

/// Returns the longest desired increment. It exceeds the radius slightly, for the rounding of a
/// caller that limits its increments to the radius. [length]
constexpr double longest_motion(const StepOptions& options) noexcept {
  return options.radius * (1.0 + 1e-9);
}

/// Capacity for the largest step. A step that needs more ends with over_capacity.
struct Capacity {
  /// Candidates of one query. With the certified rule on an index that traverses along motions, a
  /// step makes queries only to classify a tip.
  std::size_t triangles = std::size_t{1} << 16;
  /// Planes of a rule at the same time; see most_cutting_planes.
  std::size_t planes = std::size_t{1} << 14;
  std::size_t variables = 7;    // columns of the Jacobian, or 3 without one
  std::size_t extra_rows = 64;  // the caller's own rows
  std::size_t nodes = 0;        // of the branch and bound; at least StepOptions::nodes
  /// Work units of one cycle: see Budget. A motion that cannot be proved within them is not
  /// returned. 0: work_units_of_traversals on an index that traverses along motions, such as
  /// wide_bvh, else work_units_of_queries. Other indices return all triangles in the region.
  std::size_t work_units = 0;
  std::size_t looks = 0;  // deprecated: use work_units

  /// The default for an index that traverses along motions.
  static constexpr std::size_t work_units_of_traversals = std::size_t{11} << 13;
  static constexpr std::size_t work_units_of_queries = std::size_t{1} << 22;  // not for real time

  /// Returns `work_units`, or if that is 0, the default for an index. Allocates.
  static std::size_t work_units_or_default(std::size_t work_units, const SpatialIndex& index);
};

/// The table of these options.
inline constexpr std::array capacity_options{
    option<&Capacity::triangles>("max_triangles", "", {0, 4294967296.0},
                                 "Capacity for the triangles of one query."),
    option<&Capacity::planes>("max_planes", "", {0, 1 << 30}, "Capacity for the planes of a step."),
    option<&Capacity::variables>("max_joints", "", {0, 2147483647.0},
                                 "Capacity for the columns of a Jacobian."),
    option<&Capacity::extra_rows>("max_rows", "", {0, 1 << 30},
                                  "Capacity for the caller's own rows."),
    option<&Capacity::work_units>(
        "max_work_units", "", {0, static_cast<double>(Budget::unlimited)},
        "Work budget of a cycle, in work units; 0: 90,112 on wide_bvh, 4,194,304 on other "
        "indices.")};

/// See table_of(const StepOptions&).
constexpr const auto& table_of(const Capacity&) { return capacity_options; }

}  // namespace keepout
