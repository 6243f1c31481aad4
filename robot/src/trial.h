// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "joint_problem.h"

namespace keepout {

/// A motion on trial, and the part of it that is proved.
struct Trial {
  JointVector increment{};
  int knot = 0;           // the motion is proved up to this knot
  double fraction = 0.0;  // of the motion that is executed: of the proved part, what costs least
  double cost = 0.0;      // of that fraction
  double missed = 0.0;    // of a task of the flange, by its true motion: see flange_error
  Limits limits = {};     // what keeps it from being the commanded motion
  GuideSet guides = {};   // the guides that limit it
  std::size_t rows = 0;   // that limit it, joint limits apart
  Relaxation relaxation = Relaxation::none;  // what was relaxed

  /// Returns true if all of the motion is proved.
  bool is_proved() const noexcept { return knot == PointMotion::last_knot; }
  /// Returns the fraction that is proved.
  double proved() const noexcept { return static_cast<double>(knot) / PointMotion::last_knot; }
};

}  // namespace keepout
