// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/factory/make_motion_constraint.h"

#include <array>
#include <cstdio>
#include <string>
#include <utility>

#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/error.h"
#include "keepout/index/index_cache.h"
#include "keepout/index/triangle_blocks.h"
#include "keepout/solvers/registry.h"

namespace keepout {

namespace {

std::unique_ptr<SpatialIndex> make_or_load_index(std::shared_ptr<const Mesh> mesh,
                                                 const MotionConstraintSettings& settings) {
  if (settings.index == "wide_bvh" && !settings.index_cache.empty()) {
    return load_or_build(std::move(mesh), settings.index_cache, settings.warn);
  }
  return make_index(settings.index, std::move(mesh));
}

/// Where the rounding of the index's floats is no longer small beside the distance kept, it clears
/// little, and most triangles in reach are asked about in double.
void warn_of_coarse_index(const SpatialIndex& index, const MotionConstraintSettings& settings) {
  const double kept = settings.tool_radius + settings.margin;
  const double rounding = index.blocks() != nullptr ? index.blocks()->frame().error : 0.0;
  if (!settings.warn || !(32.0 * rounding > kept)) return;
  const auto length = [](double value) {
    std::array<char, 32> digits;
    std::snprintf(digits.data(), digits.size(), "%g", value);
    return std::string(digits.data());
  };
  settings.warn(
      "the mesh is so large beside the distance kept that its index, which is off by up to " +
      length(rounding) +
      ", cannot tell which triangles are near: steps are as safe, but slow, and shorter where that "
      "takes too long; keep more than " +
      length(32.0 * rounding) + ", or cut out the part of the mesh that matters");
}

}  // namespace

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
  if (index) warn_of_coarse_index(*index, settings);
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
