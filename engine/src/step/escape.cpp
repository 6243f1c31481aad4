// SPDX-License-Identifier: BSD-3-Clause
#include "escape.h"

#include <algorithm>

namespace keepout {

Vec3 escape_motion(Neighborhood& near, const Vec3& tip, const SideOfSurface& side, double longest,
                   double off) noexcept {
  // What cannot get through in one go stops short of the surface.
  if (side.distance + off > longest) {
    const double rest = std::max(side.distance - off, 0.5 * side.distance);
    return std::min(longest, rest) * side.outward;
  }
  // Close to the surface no farther than needed, as another wall may stand there.
  const double through = side.distance + off;
  Vec3 best = side.distance * side.outward;  // on the surface, and on from there
  double most = 0.0;
  const auto consider = [&](const Vec3& motion) {
    if (most >= 0.5 * off) return;
    const auto there = find_side(near, tip + motion);
    if (!there || !there->is_outside || there->distance <= most) return;
    most = there->distance;
    best = motion;
  };
  consider(through * side.outward);
  consider(through * side.normal);
  // At a saddle neither need lead out.
  for (int i = 0; i < 27; ++i) {
    const Vec3 towards(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (!towards.isZero()) consider(through * towards.normalized());
  }
  return best;
}

namespace {

/// Far above the distance at which the certified rule can no longer tell a side. [length]
double well_off(const Mesh& mesh, const StepOptions& options) noexcept {
  const double size = mesh.bounds().size().norm() + options.radius + required_clearance(options);
  return std::max(1e-4 * options.recovery, 1e-8 * size);
}

double longest_escape(const StepOptions& options) noexcept {
  return std::min(options.recovery, options.radius);
}

bool may_escape(const Motion& motion, const StepOptions& options, const Mesh& mesh) noexcept {
  return !motion.jacobian && !motion.rows && longest_escape(options) >= well_off(mesh, options);
}

Step escape_step(const SideOfSurface& side, Neighborhood& near, const Motion& motion,
                 const StepOptions& options, Workspace& work) noexcept {
  Step result{.status = Status::recovering, .distance = side.distance};
  result.motion = escape_motion(near, motion.tip, side, longest_escape(options),
                                well_off(near.mesh(), options));
  work.solution = {};
  result.motion.array() += 0.0;  // no zero has a sign
  work.store_result(motion, result.motion, 1.0, Relaxation::none, {});
  result.increment = work.increment();
  return result;
}

}  // namespace

bool escape_from_inside(Neighborhood& near, const Motion& motion, const StepOptions& options,
                        Workspace& work, Step& step) noexcept {
  const auto side = find_side(near, motion.tip);
  if (!side) {
    step.status = near.budget().status_at_end();
    return true;
  }
  if (side->is_outside) return false;
  const bool may_be = may_escape(motion, options, near.mesh()) && side->distance <= options.deepest;
  if (may_be) step = escape_step(*side, near, motion, options, work);
  if (!may_be || !work.guides.allow(step.motion)) {
    step = {.status = Status::inside, .distance = side->distance};
  }
  return true;
}

bool escape_from_surface(Neighborhood& near, const Motion& motion, const StepOptions& options,
                         Workspace& work, Step& step) noexcept {
  if (!may_escape(motion, options, near.mesh())) return false;
  const auto side = find_side(near, motion.tip);
  if (!side) return false;
  const Step off = escape_step(*side, near, motion, options, work);
  if (off.motion.isZero(0.0) || !work.guides.allow(off.motion)) return false;
  step = off;
  return true;
}

}  // namespace keepout
