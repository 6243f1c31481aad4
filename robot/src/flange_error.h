// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "joint_task.h"
#include "trial.h"

namespace keepout {

/// What the true motion of the flange misses. The certificate proves a motion clear; it does not
/// say that the flange moves as the linear task predicts.
struct FlangeError {
  double missed;  // of the task, or a bound of it if the motion is certain to make half of it
  bool strays;    // the motion makes less than half of the predicted gain, or ends farther off
};

/// Returns the error of the flange for a trial motion. `motion`: that motion. Precondition: the
/// task is one of the flange.
FlangeError flange_error(const JointTask& task, const Trial& trial, const Chain& chain,
                         PointMotion& motion) noexcept;

/// Returns a trial cut to the fraction, of halves, that costs least for the true flange; to zero if
/// all of them cost more than zero motion. `motion`: the trial's.
Trial cut_for_flange(const JointTask& task, Trial trial, PointMotion& motion) noexcept;

}  // namespace keepout
