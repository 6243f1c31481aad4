// SPDX-License-Identifier: BSD-3-Clause
#include "escape.h"

#include <algorithm>

namespace keepout {

Vec3 escape_motion(Neighborhood& neighborhood, const Vec3& tip, const SideOfSurface& side,
                   double longest, double clear_by) noexcept {
  const double through = side.distance + clear_by;
  // An escape that cannot get through the surface in one cycle stops short of it.
  if (through > longest) {
    const double rest = std::max(side.distance - clear_by, 0.5 * side.distance);
    return std::min(longest, rest) * side.outward;
  }
  // Goes no farther beyond the surface than needed, because another wall may stand there.
  Vec3 best = side.distance * side.outward;  // onto the surface, unless a better end is found
  double best_distance = 0.0;                // from that end to the surface
  const auto consider = [&](const Vec3& motion) {
    if (best_distance >= 0.5 * clear_by) return;  // good enough
    const auto there = find_side(neighborhood, tip + motion);
    if (!there || !there->is_outside || there->distance <= best_distance) return;
    best_distance = there->distance;
    best = motion;
  };
  consider(through * side.outward);
  consider(through * side.normal);
  // At a saddle both ends may be inside.
  for (int i = 0; i < 27; ++i) {
    const Vec3 towards(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (!towards.isZero()) consider(through * towards.normalized());
  }
  return best;
}

namespace {

/// Returns the distance from the surface at which an escape ends. It is far above touching_within,
/// the distance at which the certified rule can no longer determine a side. [length]
double escape_clearance(const Mesh& mesh, const StepOptions& options) noexcept {
  const double size = mesh.bounds().size().norm() + options.radius + required_clearance(options);
  return std::max(1e-4 * options.recovery, 1e-8 * size);
}

/// Returns the length of the longest escape in a cycle. [length]
double longest_escape(const StepOptions& options) noexcept {
  return std::min(options.recovery, options.radius);
}

/// Returns true if a straight escape is possible. Joints and rows exclude it, as they need not
/// allow a straight motion.
bool may_escape(const Motion& request, const StepOptions& options, const Mesh& mesh) noexcept {
  return !request.jacobian && !request.rows &&
         longest_escape(options) >= escape_clearance(mesh, options);
}

/// Returns the step of an escape. Returns nothing if there is no way out, or a guide forbids it.
std::optional<Step> escape_step(const SideOfSurface& side, Neighborhood& neighborhood,
                                const Motion& request, const StepOptions& options,
                                TipMemory& memory) noexcept {
  const Vec3 motion =
      without_signed_zeros(escape_motion(neighborhood, request.tip, side, longest_escape(options),
                                         escape_clearance(neighborhood.mesh(), options)));
  if (motion.isZero(0.0) || !memory.guides.allow(motion)) return std::nullopt;
  memory.store_result(request, motion, 1.0, {}, Relaxation::none, {});
  return Step{.status = Status::recovering,
              .motion = motion,
              .increment = memory.increment(),
              .distance = side.distance};
}

}  // namespace

std::optional<Step> step_of_tip_inside(Neighborhood& neighborhood, const Motion& request,
                                       const StepOptions& options, TipMemory& memory) noexcept {
  const auto side = find_side(neighborhood, request.tip);
  if (!side) return Step{.status = neighborhood.budget().failure()};
  if (side->is_outside) return std::nullopt;
  if (may_escape(request, options, neighborhood.mesh()) && side->distance <= options.deepest) {
    if (const auto escape = escape_step(*side, neighborhood, request, options, memory)) {
      return escape;
    }
  }
  return Step{.status = Status::inside, .distance = side->distance};
}

std::optional<Step> escape_from_surface(Neighborhood& neighborhood, const Motion& request,
                                        const StepOptions& options, TipMemory& memory) noexcept {
  if (!may_escape(request, options, neighborhood.mesh())) return std::nullopt;
  const auto side = find_side(neighborhood, request.tip);
  if (!side) return std::nullopt;
  return escape_step(*side, neighborhood, request, options, memory);
}

}  // namespace keepout
