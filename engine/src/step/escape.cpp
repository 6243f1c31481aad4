// SPDX-License-Identifier: BSD-3-Clause
#include "escape.h"

#include <algorithm>

namespace keepout {

Vec3 escape_motion(Neighborhood& near, const Vec3& tip, const SideOfSurface& side, double longest,
                   double clear_by) noexcept {
  const double through = side.distance + clear_by;
  // An escape that cannot get through in one cycle stops short of the surface.
  if (through > longest) {
    const double rest = std::max(side.distance - clear_by, 0.5 * side.distance);
    return std::min(longest, rest) * side.outward;
  }
  // Beyond the surface no farther than needed, as another wall may stand there.
  Vec3 best = side.distance * side.outward;  // onto the surface, unless a better end is found
  double best_distance = 0.0;                // of that end from the surface
  const auto consider = [&](const Vec3& motion) {
    if (best_distance >= 0.5 * clear_by) return;  // good enough
    const auto there = find_side(near, tip + motion);
    if (!there || !there->is_outside || there->distance <= best_distance) return;
    best_distance = there->distance;
    best = motion;
  };
  consider(through * side.outward);
  consider(through * side.normal);
  // At a saddle both may end inside.
  for (int i = 0; i < 27; ++i) {
    const Vec3 towards(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (!towards.isZero()) consider(through * towards.normalized());
  }
  return best;
}

namespace {

/// Returns the distance from the surface at which an escape ends: far above the distance at which
/// the certified rule can no longer determine a side. [length]
double escape_clearance(const Mesh& mesh, const StepOptions& options) noexcept {
  const double size = mesh.bounds().size().norm() + options.radius + required_clearance(options);
  return std::max(1e-4 * options.recovery, 1e-8 * size);
}

double longest_escape(const StepOptions& options) noexcept {
  return std::min(options.recovery, options.radius);
}

bool may_escape(const Motion& request, const StepOptions& options, const Mesh& mesh) noexcept {
  return !request.jacobian && !request.rows &&
         longest_escape(options) >= escape_clearance(mesh, options);
}

Step escape_step(const SideOfSurface& side, Neighborhood& near, const Motion& request,
                 const StepOptions& options, Workspace& work) noexcept {
  const Vec3 motion = without_signed_zeros(escape_motion(
      near, request.tip, side, longest_escape(options), escape_clearance(near.mesh(), options)));
  work.solution = {};
  work.store_result(request, motion, 1.0, Relaxation::none, {});
  return {.status = Status::recovering,
          .motion = motion,
          .increment = work.increment(),
          .distance = side.distance};
}

}  // namespace

bool escape_if_inside(Neighborhood& near, const Motion& request, const StepOptions& options,
                      Workspace& work, Step& step) noexcept {
  const auto side = find_side(near, request.tip);
  if (!side) {
    step.status = near.budget().status_at_end();
    return true;
  }
  if (side->is_outside) return false;
  if (may_escape(request, options, near.mesh()) && side->distance <= options.deepest) {
    step = escape_step(*side, near, request, options, work);
    if (work.guides.allow(step.motion)) return true;
  }
  step = {.status = Status::inside, .distance = side->distance};
  return true;
}

bool escape_from_surface(Neighborhood& near, const Motion& request, const StepOptions& options,
                         Workspace& work, Step& step) noexcept {
  if (!may_escape(request, options, near.mesh())) return false;
  const auto side = find_side(near, request.tip);
  if (!side) return false;
  const Step escape = escape_step(*side, near, request, options, work);
  if (escape.motion.isZero(0.0) || !work.guides.allow(escape.motion)) return false;
  step = escape;
  return true;
}

}  // namespace keepout
