// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/side_watch.h"

#include <algorithm>

#include "keepout/step/placement.h"

namespace keepout {

SideWatch SideWatch::of_watertight() noexcept {
  SideWatch watch;
  watch.is_on_ = true;
  return watch;
}

std::optional<Step> SideWatch::before(const Mesh& mesh, const SpatialIndex& index,
                                      const Motion& motion, const StepOptions& options,
                                      Workspace& work) const noexcept {
  if (!is_on_ || (motion.tip - free_tip_).norm() <= free_around_) return std::nullopt;
  const std::optional<Placement> placement = place(mesh, index, motion.tip, work.candidates);
  Step result;
  result.status = Status::over_capacity;
  if (!placement) return result;
  // Far above the distance at which the certified rule can no longer tell a side.
  const double size = mesh.bounds().size().norm() + options.radius + options.margin;
  const double off = std::max(1e-4 * options.recovery, 1e-8 * size);
  const bool is_free = placement->side == Placement::Side::free;
  if (is_free && placement->distance >= 0.5 * off) return std::nullopt;
  const double longest = std::min(options.recovery, options.radius);
  result.status = Status::inside;
  if (motion.jacobian || motion.rows || placement->distance > options.deepest || longest < off) {
    return is_free ? std::nullopt : std::optional(result);
  }
  result.status = Status::recovering;
  result.motion = lead_out(mesh, index, motion.tip, *placement, longest, off, work.candidates);
  work.note({}, result.motion);
  result.increment = work.increment();
  return result;
}

void SideWatch::after(const Motion& motion, const Step& step, const StepOptions& options) noexcept {
  free_tip_ = motion.tip + step.motion;
  // A margin that is kept leaves more than half of itself free, whatever the tolerance.
  const bool keeps_the_margin = step.ok() && step.status != Status::recovering;
  free_around_ = keeps_the_margin ? 0.5 * options.margin : 0.0;
}

}  // namespace keepout
