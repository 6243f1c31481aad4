// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "keepout/geometry/convex_tool.h"
#include "keepout/step/motion_constraint.h"

namespace keepout {

/// Which parts to build a motion constraint from, by name, and how it shall behave.
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
  double radius = 5.0;       // of the motion sphere: the farthest that the tip may go [length]
  double tool_radius = 0.0;  // of the ball around the tip that shall not touch the mesh [length]
  /// What shall not touch the mesh instead of that ball; tool_of_text() makes one of a text. It is
  /// kept out by a rule of its own, ConvexToolRule: activation stays "certified" and tool_radius 0,
  /// inside, refinements and nodes have no effect. Empty: the ball.
  std::optional<ConvexTool> tool = {};
  std::string narrow_phase = "exact";  // of a tool; see narrow_phase_backends()
  double margin = 0.2;                 // distance to keep beyond that; certified needs one [length]
  double damping = 0.0;         // weight of |u|^2 beside the task: above 0 with more than 3 joints
  double recovery = 0.05;       // how far a tip that is too close is led away in a cycle [length]
  double deepest = 10.0;        // no tip is led out from deeper inside [length]
  int refinements = 3;          // how often a certified motion is improved upon
  int nodes = 0;                // of a branch and bound for a better motion still; 0: none
  Query query = Query::motion;  // how far around the tip triangles are looked for
  Distances distances = Distances::where_known;  // of which tips Step::distance is told
  Inside inside = Inside::led_out;  // what becomes of a tip that starts inside; a ball's, certified
  Capacity capacity = {};           // the largest step there is room for
};

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
