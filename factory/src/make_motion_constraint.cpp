// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/factory/make_motion_constraint.h"

#include <utility>

#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/error.h"
#include "keepout/solvers/registry.h"

namespace keepout {

MotionConstraint make_motion_constraint(std::shared_ptr<const Mesh> mesh,
                                        const MotionConstraintSettings& settings) {
  if (!mesh) throw Error("a motion constraint needs a mesh: none was given");
  auto index = make_index(settings.index, mesh);
  auto activation = make_activation(settings.activation, mesh);
  auto solver = make_solver(settings.solver);
  return {std::move(mesh),
          std::move(index),
          std::move(activation),
          std::move(solver),
          {.radius = settings.radius,
           .margin = settings.tool_radius + settings.margin,
           .damping = settings.damping,
           .recovery = settings.recovery,
           .deepest = settings.deepest,
           .refinements = settings.refinements,
           .nodes = settings.nodes,
           .query = settings.query},
          settings.capacity,
          settings.activation == "certified" ? settings.inside : Inside::taken_as_is};
}

}  // namespace keepout
