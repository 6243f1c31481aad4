// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "keepout/step/motion_constraint.h"

namespace keepout {

/// Which parts to build a motion constraint from, by name, and how it shall behave.
struct MotionConstraintSettings {
  std::string index = "pd_tree";
  std::string activation = "paper";
  std::string solver = "active_set";
  double radius = 5.0;   // of the motion sphere [length]; 5 mm is the paper's
  double margin = 0.0;   // distance to keep from the mesh [length]
  double damping = 0.0;  // weight of |u|^2 beside the task
  Capacity capacity = {};
};

/// Builds the parts and puts them together. Throws Error, listing what exists, for a name that does
/// not, and for settings out of range.
MotionConstraint make_motion_constraint(std::shared_ptr<const Mesh> mesh,
                                        const MotionConstraintSettings& settings);

}  // namespace keepout
