// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/index/budget.h"
#include "keepout/robot/instrument.h"
#include "keepout/robot/instrument_options.h"
#include "keepout/step/guide.h"
#include "point_motion.h"

namespace keepout {

/// The constants of one cycle, and the two things that its parts share and change: the motion of
/// the joints on trial, and the work budget.
struct CycleContext {
  const Instrument& instrument;
  const InstrumentOptions& options;
  double tolerance;  // distances are equal within this [length]
  bool meshes_move;  // in this cycle
  PointMotion& motion;
  Budget& budget;
};

/// Returns the tolerance of a guide's excess, if distances are equal within `tolerance`. A
/// direction is rounded by some 1e-15, and joint positions by some 1e-14 rad, whatever the lengths.
/// [length or rad]
inline double tolerance_of(const Guide& guide, double tolerance) noexcept {
  return guide.is_angular() ? 1e-12 : tolerance;
}

}  // namespace keepout
