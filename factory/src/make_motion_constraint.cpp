// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/factory/make_motion_constraint.h"

#include <utility>

#include "chosen_index.h"
#include "keepout/activation/registry.h"
#include "keepout/error.h"
#include "keepout/solvers/registry.h"

namespace keepout {

std::shared_ptr<const SpatialIndex> make_or_load_index(std::shared_ptr<const Mesh> mesh,
                                                       const MotionConstraintSettings& settings) {
  return make_or_load_index(std::move(mesh), settings.index, settings.index_cache, settings.warn);
}

MotionConstraint make_motion_constraint(std::shared_ptr<const Mesh> mesh,
                                        const MotionConstraintSettings& settings) {
  if (!mesh) throw Error("a motion constraint needs a mesh: none was given");
  auto index = make_or_load_index(mesh, settings);
  return make_motion_constraint(std::move(mesh), std::move(index), settings);
}

MotionConstraint make_motion_constraint(std::shared_ptr<const Mesh> mesh,
                                        std::shared_ptr<const SpatialIndex> index,
                                        const MotionConstraintSettings& settings) {
  if (!mesh) throw Error("a motion constraint needs a mesh: none was given");
  if (index) {
    warn_of_coarse_index(*index, settings.tool_radius + settings.margin, settings.warn);
  }
  auto activation = make_activation(settings.activation);
  auto solver = make_solver(settings.solver);
  return {std::move(mesh),
          std::move(index),
          std::move(activation),
          std::move(solver),
          {.radius = settings.radius,
           .tool_radius = settings.tool_radius,
           .margin = settings.margin,
           .damping = settings.damping,
           .recovery = settings.recovery,
           .deepest = settings.deepest,
           .refinements = settings.refinements,
           .nodes = settings.nodes,
           .query = settings.query,
           .distances = settings.distances},
          settings.capacity,
          settings.activation == "certified" ? settings.inside : Inside::taken_as_is};
}

}  // namespace keepout
