// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "keepout/geometry/convex_tool.h"
#include "keepout/step/motion_constraint.h"

namespace keepout {

/// Parts of a motion constraint, by name, and its options.
struct MotionConstraintSettings {
  std::string index = "wide_bvh";  // see index_backends(); fcl_collide is not for real time
  /// The folder where built indices are kept; only wide_bvh is. Empty: none is kept.
  std::filesystem::path index_cache = {};
  /// Told while building of what does no harm but should be known: that an index could not be kept,
  /// or that the mesh is so large beside the distance kept that steps are slow. Empty: nobody is
  /// told.
  std::function<void(const std::string&)> warn = {};
  std::string activation = "certified";  // see activation_rules()
  std::string solver = "active_set";     // see solver_backends()
  StepOptions options = {};              // that stay the same from step to step
  /// Tool that must not touch the mesh, in place of the ball of options.tool_radius; tool_of_text()
  /// reads one from a text. ConvexToolRule guards it: activation stays "certified" and tool_radius
  /// 0; inside, refinements and nodes have no effect. Empty: the ball.
  std::optional<ConvexTool> tool = {};
  std::string narrow_phase = "exact";  // of a tool; see narrow_phase_backends()
  /// What becomes of a tip that starts inside; of a ball, under the rule certified. The constructor
  /// of MotionConstraint takes any rule: its default is Inside::taken_as_is.
  Inside inside = Inside::escape;
  Capacity capacity = {};  // for the largest step
};

/// The table of the settings that are neither in StepOptions nor in Capacity.
inline constexpr std::array motion_settings{
    option<&MotionConstraintSettings::activation>(
        "activation", "Rule that turns triangles into planes: see activation_rules()."),
    option<&MotionConstraintSettings::solver>("solver",
                                              "Solver of the step problem: see solver_backends()."),
    option<&MotionConstraintSettings::narrow_phase>(
        "narrow_phase", "Proposer of the planes of a convex tool: see narrow_phase_backends()."),
    option<&MotionConstraintSettings::inside, inside_names>(
        "inside",
        "Treatment of a tip that starts on the forbidden side: it is led out, or its side is not "
        "checked.")};

/// See table_of(const StepOptions&).
constexpr const auto& table_of(const MotionConstraintSettings&) { return motion_settings; }

/// The index that the settings name, from index_cache where it is kept there: for constraints that
/// share it. Throws Error for a name that does not exist.
std::shared_ptr<const SpatialIndex> make_or_load_index(std::shared_ptr<const Mesh> mesh,
                                                       const MotionConstraintSettings& settings);

/// Builds the parts and puts them together. Throws Error, listing what exists, for a name that does
/// not, and for settings out of range, or that contradict each other, as a tool and a tool_radius.
MotionConstraint make_motion_constraint(std::shared_ptr<const Mesh> mesh,
                                        const MotionConstraintSettings& settings);

/// The same on an index that is there already, built on this mesh: settings.index and index_cache
/// are not looked at. Constraints of many threads may share it, as they share the mesh.
MotionConstraint make_motion_constraint(std::shared_ptr<const Mesh> mesh,
                                        std::shared_ptr<const SpatialIndex> index,
                                        const MotionConstraintSettings& settings);

}  // namespace keepout
