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
  work.keep_answer(motion, result.motion, 1.0);
  result.increment = work.increment();
  return result;
}

}  // namespace

bool lead_out_from_inside(Neighborhood& near, const Motion& motion, const StepOptions& options,
                          Workspace& work, Step& step) noexcept {
  const auto placement = place(near.mesh(), near.index(), motion.tip, near.candidates());
  if (!placement) {
    step.status = Status::over_capacity;
    return true;
  }
  if (placement->is_free) return false;
  if (!may_be_led(motion, options, near.mesh()) || placement->distance > options.deepest) {
    step.status = Status::inside;
    step.distance = placement->distance;
  } else {
    step = led_out(*placement, near, motion, options, work);
  }
  return true;
}

bool lead_off_surface(Neighborhood& near, const Motion& motion, const StepOptions& options,
                      Workspace& work, Step& step) noexcept {
  if (!may_be_led(motion, options, near.mesh())) return false;
  const auto placement = place(near.mesh(), near.index(), motion.tip, near.candidates());
  if (!placement) return false;
  const Step off = led_out(*placement, near, motion, options, work);
  if (off.motion.isZero(0.0)) return false;
  step = off;
  return true;
}

}  // namespace keepout
