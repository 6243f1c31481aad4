// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "joint_task.h"
#include "trial.h"

namespace keepout {

/// The distance by which the true motion of the flange misses its task. The certificate proves a
/// motion clear, but not that the flange moves as the linear task predicts.
struct FlangeError {
  double missed;  // the miss, or a bound of it that is at most half of the task
  bool strays;    // the motion makes less than half of the predicted gain, or ends farther from the
                  // target than it starts
};

/// Returns the error of the flange for a trial motion. `motion`: that motion. Precondition: the
/// task is one of the flange.
FlangeError flange_error(const JointTask& task, const Trial& trial, const Chain& chain,
                         PointMotion& motion) noexcept;

/// Returns a trial whose fraction is halved until its cost, for the true motion of the flange, is
/// lowest. The fraction is zero if none of 13 costs less than zero motion. `motion`: that of the
/// trial.
Trial cut_for_flange(const JointTask& task, Trial trial, PointMotion& motion) noexcept;

}  // namespace keepout
