// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "keepout/factory/make_motion_constraint.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/mesh/load_mesh.h"

/// A mesh, the one index that all tools on it share, and the warnings of its file.
struct Anatomy {
  explicit Anatomy(keepout::LoadedMesh loaded)
      : mesh(std::move(loaded.mesh)),
        index(std::make_shared<const keepout::WideBvh>(mesh)),
        warnings(std::move(loaded.warnings)) {}

  explicit Anatomy(keepout::Surface surface)
      : Anatomy(keepout::LoadedMesh{
            .mesh = std::make_shared<const keepout::Mesh>(std::move(surface))}) {}

  /// Returns a motion constraint on the mesh.
  keepout::MotionConstraint guard(const keepout::MotionConstraintSettings& settings) const {
    return make_motion_constraint(mesh, index, settings);
  }

  /// Returns the distance from a position to the nearest triangle; below 0 inside a watertight
  /// mesh, NaN if it is unknown. [mm]
  double clearance(double x, double y, double z) try {
    if (!probe) {
      // The probe has no retreat, so the winding number alone decides if a position is inside.
      const double size = mesh->bounds().size().norm();
      probe = std::make_unique<keepout::MotionConstraint>(
          guard({.options = {.radius = 1e-3 * size,
                             .margin = 1e-6 * size,
                             .deepest = 0.0,
                             .distances = keepout::Distances::always}}));
    }
    probe->forget();
    const keepout::Step step = probe->step({.tip = {x, y, z}, .desired = keepout::Vec3::Zero()});
    if (!step.distance) return std::numeric_limits<double>::quiet_NaN();
    return step.status == keepout::Status::inside ? -*step.distance : *step.distance;
  } catch (const std::exception&) {
    return std::numeric_limits<double>::quiet_NaN();
  }

  std::shared_ptr<const keepout::Mesh> mesh;
  std::shared_ptr<const keepout::SpatialIndex> index;
  std::vector<std::string> warnings;
  std::unique_ptr<keepout::MotionConstraint> probe;  // of clearance(); null before its first call
};
