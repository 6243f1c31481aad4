// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/factory/make_motion_constraint.h"

#include <utility>

#include "chosen_index.h"
#include "keepout/activation/convex_tool_rule.h"
#include "keepout/activation/registry.h"
#include "keepout/adapters/narrow_phase_registry.h"
#include "keepout/error.h"
#include "keepout/monitor/monitors.h"
#include "keepout/solvers/registry.h"

namespace keepout {
namespace {

/// Returns the rule of the settings' tool, or the rule that they name. Throws Error if the settings
/// contradict each other.
std::unique_ptr<ActivationRule> make_rule(const MotionConstraintSettings& settings) {
#if KEEPOUT_BALLS_ONLY
  if (settings.tool) throw Error("this build guards balls alone");
  return make_activation(settings.activation);
#else
  if (!settings.tool) {
    if (settings.narrow_phase == "exact") return make_activation(settings.activation);
    throw Error("the narrow phase '" + settings.narrow_phase + "' is for a convex tool: give one");
  }
  if (settings.options.tool_radius != 0.0) {
    throw Error("a convex tool replaces the ball: leave tool_radius at 0");
  }
  if (settings.activation != "certified") {
    throw Error("a convex tool has a rule of its own: leave activation at 'certified', not '" +
                settings.activation + "'");
  }
  return std::make_unique<ConvexToolRule>(*settings.tool,
                                          make_narrow_phase(settings.narrow_phase, *settings.tool));
#endif
}

}  // namespace

std::shared_ptr<const SpatialIndex> make_or_load_index(std::shared_ptr<const Mesh> mesh,
                                                       const MotionConstraintSettings& settings) {
  return make_or_load_index(std::move(mesh), settings.index, settings.index_cache, settings.warn);
}

MotionConstraint make_motion_constraint(std::shared_ptr<const Mesh> mesh,
                                        const MotionConstraintSettings& settings) {
  if (!mesh) throw Error("a motion constraint needs a mesh, but it is null");
  auto index = make_or_load_index(mesh, settings);
  return make_motion_constraint(std::move(mesh), std::move(index), settings);
}

MotionConstraint make_motion_constraint(std::shared_ptr<const Mesh> mesh,
                                        std::shared_ptr<const SpatialIndex> index,
                                        const MotionConstraintSettings& settings) {
  // Only the certified rule of a ball determines sides; for other rules `inside` has no effect.
  const bool rule_knows_sides = settings.activation == "certified" && !settings.tool;
  MotionConstraint constraint(mesh, index, make_rule(settings), make_solver(settings.solver),
                              settings.options, settings.capacity,
                              rule_knows_sides ? settings.inside : Inside::taken_as_is);
#if KEEPOUT_BALLS_ONLY
  if (settings.monitor) throw Error("this build has no monitor");
#else
  if (settings.monitor) constraint.set_monitor(monitor::make_tip_monitor(std::move(mesh)));
#endif
  // After the settings are accepted, so that rejected settings cause no warning.
  warn_of_coarse_index(*index, required_clearance(settings.options), settings.warn);
  return constraint;
}

}  // namespace keepout
