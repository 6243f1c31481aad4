// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/side_watch.h"

#include <algorithm>

#include "keepout/step/placement.h"

namespace keepout {
namespace {

/// Far above the distance at which the certified rule can no longer tell a side. [length]
double well_off(const Mesh& mesh, const StepOptions& options) noexcept {
  const double size = mesh.bounds().size().norm() + options.radius + distance_kept(options);
  return std::max(1e-4 * options.recovery, 1e-8 * size);
}

double longest_way(const StepOptions& options) noexcept {
  return std::min(options.recovery, options.radius);
}

bool may_be_led(const Motion& motion, const StepOptions& options, const Mesh& mesh) noexcept {
  return !motion.jacobian && !motion.rows && longest_way(options) >= well_off(mesh, options);
}

Step led_out(const Placement& placement, const Mesh& mesh, const SpatialIndex& index,
             const Motion& motion, const StepOptions& options, Workspace& work) noexcept {
  Step result{.status = Status::recovering, .distance = placement.distance};
  result.motion = lead_out(mesh, index, motion.tip, placement, longest_way(options),
                           well_off(mesh, options), work.candidates);
  work.note({}, result.motion);
  result.increment = work.increment();
  return result;
}

}  // namespace

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
  if (!placement) return Step{.status = Status::over_capacity};
  if (placement->side == Placement::Side::free) return std::nullopt;
  if (!may_be_led(motion, options, mesh) || placement->distance > options.deepest) {
    return Step{.status = Status::inside, .distance = placement->distance};
  }
  return led_out(*placement, mesh, index, motion, options, work);
}

std::optional<Step> SideWatch::off_surface(const Mesh& mesh, const SpatialIndex& index,
                                           const Motion& motion, const StepOptions& options,
                                           Workspace& work) const noexcept {
  if (!is_on_ || !may_be_led(motion, options, mesh)) return std::nullopt;
  const std::optional<Placement> placement = place(mesh, index, motion.tip, work.candidates);
  if (!placement) return std::nullopt;
  const Step result = led_out(*placement, mesh, index, motion, options, work);
  if (result.motion.isZero(0.0)) return std::nullopt;
  return result;
}

void SideWatch::after(const Motion& motion, const Step& step, const StepOptions& options) noexcept {
  free_tip_ = motion.tip + step.motion;
  // A margin that is kept leaves more than half of itself free, whatever the tolerance.
  const bool keeps_the_margin = step.ok() && step.status != Status::recovering;
  free_around_ = keeps_the_margin ? 0.5 * distance_kept(options) : 0.0;
}

void SideWatch::forget() noexcept { free_tip_ = Motion::unset; }

}  // namespace keepout
