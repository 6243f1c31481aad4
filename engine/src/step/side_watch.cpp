// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/side_watch.h"

namespace keepout {

SideWatch SideWatch::of_watertight() noexcept {
  SideWatch watch;
  watch.is_on_ = true;
  return watch;
}

void SideWatch::after(const Motion& motion, const Step& step, const StepOptions& options) noexcept {
  free_tip_ = motion.tip + step.motion;
  // A margin that is kept leaves more than half of itself free, whatever the tolerance.
  const bool keeps_the_margin = step.ok() && step.status != Status::recovering;
  free_around_ = keeps_the_margin ? 0.5 * distance_kept(options) : 0.0;
}

}  // namespace keepout
