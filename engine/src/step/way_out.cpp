// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "way_out.h"

#include <algorithm>

#include "placement.h"

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

Step led_out(const Placement& placement, Neighborhood& near, const Motion& motion,
             const StepOptions& options, Workspace& work) noexcept {
  Step result{.status = Status::recovering, .distance = placement.distance};
  result.motion = lead_out(near.mesh(), near.index(), motion.tip, placement, longest_way(options),
                           well_off(near.mesh(), options), near.candidates());
  work.solution = {};
  work.note(motion, result.motion, 1.0);
  result.increment = work.increment();
  return result;
}

}  // namespace

std::optional<Step> step_from_inside(Neighborhood& near, const Motion& motion,
                                     const StepOptions& options, Workspace& work) noexcept {
  const auto placement = place(near.mesh(), near.index(), motion.tip, near.candidates());
  if (!placement) return Step{.status = Status::over_capacity};
  if (placement->is_free) return std::nullopt;
  if (!may_be_led(motion, options, near.mesh()) || placement->distance > options.deepest) {
    return Step{.status = Status::inside, .distance = placement->distance};
  }
  return led_out(*placement, near, motion, options, work);
}

std::optional<Step> step_off_surface(Neighborhood& near, const Motion& motion,
                                     const StepOptions& options, Workspace& work) noexcept {
  if (!may_be_led(motion, options, near.mesh())) return std::nullopt;
  const auto placement = place(near.mesh(), near.index(), motion.tip, near.candidates());
  if (!placement) return std::nullopt;
  const Step result = led_out(*placement, near, motion, options, work);
  if (result.motion.isZero(0.0)) return std::nullopt;
  return result;
}

}  // namespace keepout
