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

/// The names of the parts of a motion constraint, and its options.
struct MotionConstraintSettings {
  std::string index = "wide_bvh";  // see index_backends(); fcl_collide is not for real time
  /// The directory of saved indices; only wide_bvh is saved. Empty: indices are not saved.
  std::filesystem::path index_cache = {};
  /// Called while building, with two kinds of harmless warnings. Either the index could not be
  /// saved, or steps are slow because the mesh is so large relative to the required clearance. May
  /// be empty.
  std::function<void(const std::string&)> warn = {};
  std::string activation = "certified";  // see activation_rules()
  std::string solver = "active_set";     // see solver_backends()
  StepOptions options = {};              // the same in all steps
  /// The tool that must not touch the mesh, instead of the ball of options.tool_radius; see
  /// tool_of_text(). ConvexToolRule guards it: `activation` must be "certified" and tool_radius 0;
  /// `inside`, refinements and nodes have no effect. Empty: the ball.
  std::optional<ConvexTool> tool = {};
  std::string narrow_phase = "exact";  // of a tool; see narrow_phase_backends()
  /// The treatment of a tip that starts inside, for a ball with the certified rule. (The
  /// constructor of MotionConstraint accepts any rule, so its default is Inside::taken_as_is.)
  Inside inside = Inside::escape;
  bool monitor = false;    // a monitor confirms each motion: see MotionConstraint::set_monitor
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
        "Treatment of a tip that starts on the forbidden side: it escapes, or its side is not "
        "checked."),
    option<&MotionConstraintSettings::monitor>("monitor",
                                               "True if an independent monitor must confirm each "
                                               "motion. A motion that it does not confirm "
                                               "is not made: the status is unconfirmed.")};

/// See table_of(const StepOptions&).
constexpr const auto& table_of(const MotionConstraintSettings&) { return motion_settings; }

/// Returns the index that the settings name, loaded from index_cache if it is saved there. For
/// constraints that share an index. Throws Error for an unknown name.
std::shared_ptr<const SpatialIndex> make_or_load_index(std::shared_ptr<const Mesh> mesh,
                                                       const MotionConstraintSettings& settings);

/// Builds the parts and combines them. Throws Error for an unknown name, with a list of the known
/// names. Also throws Error for settings out of range or that contradict each other, such as a tool
/// and a tool_radius.
MotionConstraint make_motion_constraint(std::shared_ptr<const Mesh> mesh,
                                        const MotionConstraintSettings& settings);

/// Like the function above, but on an existing index of this mesh: ignores settings.index and
/// index_cache. Constraints of several threads may share mesh and index.
MotionConstraint make_motion_constraint(std::shared_ptr<const Mesh> mesh,
                                        std::shared_ptr<const SpatialIndex> index,
                                        const MotionConstraintSettings& settings);

}  // namespace keepout
