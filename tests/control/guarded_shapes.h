// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/factory/make_motion_constraint.h"
#include "meshes.h"

namespace keepout {

// A cube whose top is the plane z = 50, and its guard.

inline constexpr double top = 50.0;
inline constexpr double kept = 0.5;  // the margin; the tool is a point

inline MotionConstraint guard_of(std::shared_ptr<const Mesh> mesh,
                                 MotionConstraintSettings settings = {
                                     .options = {.margin = kept}}) {
  return make_motion_constraint(std::move(mesh), settings);
}

inline std::shared_ptr<const Mesh> cube() {
  static const auto mesh = mesh_of(make_cube(10.0));
  return mesh;
}

}  // namespace keepout
