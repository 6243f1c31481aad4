// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "keepout/oracle/instrument_oracle.h"
#include "keepout/robot/instrument_constraint.h"

namespace keepout::app {

/// What there is to say of a path of joint motions.
struct JointPathVerdict {
  std::size_t motions = 0;
  std::size_t too_close = 0;  // in which a body comes closer than margin - band - 3 tau
  std::size_t entering = 0;   // of them, those in which the mesh reaches into a body
  std::size_t unproven = 0;   // that `prove` does not find clear, in pieces of a millimetre
  /// The least clearance of all bodies; below 0, how deep the mesh reaches into one. Infinite where
  /// none came as near as the margin. [mm]
  double clearance = std::numeric_limits<double>::infinity();
};

/// Judges each motion between neighbours of `path`: by the oracle, at places between which no point
/// of a body goes farther than 0.05 mm, and by the guard's `prove`, in pieces.
JointPathVerdict judge_joint_path(oracle::InstrumentOracle& oracle, InstrumentConstraint& guard,
                                  std::span<const std::vector<double>> path);

}  // namespace keepout::app
