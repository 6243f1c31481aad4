// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "joint_problem.h"

namespace keepout {

/// A proposed motion on trial, and the part of it that is proved.
struct Trial : Proposal {
  int knot = 0;           // the motion is proved up to this knot; 0: nothing is proved
  double fraction = 0.0;  // the fraction to execute: the part of the proved motion that costs least
  double cost = 0.0;    // of that fraction: for the linear task, or after cut_for_flange() for the
                        // true motion of the flange
  double missed = 0.0;  // by the true motion of the flange before cut_for_flange(): FlangeError

  /// Returns true if all of the motion is proved.
  bool is_proved() const noexcept { return knot == PointMotion::last_knot; }
  /// Returns true if a part of the motion is proved, even if nothing of it is executed.
  bool is_found() const noexcept { return knot > 0; }
  /// Returns the fraction that is proved.
  double proved() const noexcept { return static_cast<double>(knot) / PointMotion::last_knot; }
};

}  // namespace keepout
