// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/motion_constraint.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "keepout/error.h"
#include "keepout/mesh/watertight.h"
#include "keepout/step/placement.h"

namespace keepout {
namespace {

/// No query finds more triangles than there are. Throws before any memory is asked for.
Capacity fitted(Capacity capacity, const Mesh* mesh, const StepOptions& options) {
  constexpr std::size_t most = std::numeric_limits<int>::max();
  if (capacity.planes > most || capacity.variables > most) {
    throw Error("a capacity of more than 2^31 - 1 planes or variables cannot be held");
  }
  capacity.nodes = std::max(capacity.nodes, static_cast<std::size_t>(std::max(options.nodes, 0)));
  if (mesh != nullptr) capacity.triangles = std::min(capacity.triangles, mesh->triangle_count());
  return capacity;
}

}  // namespace

MotionConstraint::MotionConstraint(std::shared_ptr<const Mesh> mesh,
                                   std::unique_ptr<SpatialIndex> index,
                                   std::unique_ptr<Activation> activation,
                                   std::unique_ptr<Solver> solver, const StepOptions& options,
                                   const Capacity& capacity, Inside inside)
    : mesh_(std::move(mesh)),
      index_(std::move(index)),
      activation_(std::move(activation)),
      solver_(std::move(solver)),
      options_(options),
      work_(fitted(capacity, mesh_.get(), options_)),
      polytope_(mesh_, work_.candidates.capacity()),
      has_sides_(inside == Inside::led_out && mesh_ && is_watertight(*mesh_)),
      free_tip_(Motion::unset) {
  if (!mesh_ || !index_ || !activation_ || !solver_) {
    throw Error("a motion constraint needs a mesh, an index, an activation rule and a solver");
  }
  if (!is_ok(check({.tip = Vec3::Zero(), .desired = Vec3::Zero()}, options_))) {
    throw Error(
        "the radius must be above zero, margin, damping, recovery and refinements not below, and "
        "all below 1e30");
  }
  // At the tip nearest to the origin that there can be, where rounding is least.
  const Vec3 tip = mesh_->bounds().low.cwiseMax(Vec3::Zero()).cwiseMin(mesh_->bounds().high);
  const Surroundings around =
      surroundings_of({.tip = tip, .desired = Vec3::Zero()}, options_, activation_->reach());
  work_.planes.clear();
  if (activation_->start(around, work_.planes).stance == Opening::Stance::no_margin) {
    throw Error(
        "the margin is too small for a mesh and a radius of this size: the distance kept, "
        "tool radius and margin together, must be well above 1e-9 of the longest edge and "
        "of the radius");
  }
  activation_->reserve(work_.candidates.capacity());
  solver_->reserve(static_cast<int>(work_.variables()), static_cast<int>(work_.planes.capacity()) +
                                                            static_cast<int>(work_.extra_rows()));
}

Step MotionConstraint::step(const Motion& motion) noexcept { return step(motion, Unobserved()); }

Step MotionConstraint::step(const Motion& motion, StageTimes& times) noexcept {
  return step(motion, StageClock(times));
}

template <StageObserver O>
Step MotionConstraint::step(const Motion& motion, O&& observer) noexcept {
  if (const std::optional<Step> out = lead_out_if_inside(motion)) return *out;
  const Step result =
      keepout::step(*mesh_, *index_, *activation_, *solver_, motion, options_, work_, observer);
  free_tip_ = motion.tip + result.motion;
  const bool keeps_the_margin = is_ok(result.status) && result.status != Status::recovering;
  free_around_ = keeps_the_margin ? 0.5 * options_.margin : 0.0;
  return result;
}

std::optional<Step> MotionConstraint::lead_out_if_inside(const Motion& motion) noexcept {
  if (!has_sides_ || !is_ok(check(motion, options_))) return {};
  // Nothing is nearer to where the last step ended than the margin, less the tolerance.
  if ((motion.tip - free_tip_).norm() <= free_around_) return {};
  const std::optional<Placement> placement = place(*mesh_, *index_, motion.tip, work_.candidates);
  Step result;
  if (!placement) {
    result.status = Status::over_capacity;
    return result;
  }
  if (placement->side == Placement::Side::free) return {};
  if (motion.jacobian || motion.rows) {
    result.status = Status::inside;
    return result;
  }
  result.status = Status::recovering;
  result.motion = lead_out(*placement, std::min(options_.recovery, options_.radius));
  work_.note({}, result.motion);
  result.increment = work_.increment();
  return result;
}

Polytope MotionConstraint::free_polytope(const Vec3& tip, double radius) noexcept {
  const Ball ball{tip, radius + options_.margin};
  work_.candidates.clear();
  work_.hits.clear();
  // What is no number finds nothing, and is refused there.
  if (tip.allFinite() && ball.radius >= 0.0) {
    index_->collect(ball, work_.candidates);
    if (work_.candidates.overflowed()) {
      hold_still(work_.planes);
      return {PolytopeStatus::over_capacity, work_.planes.view()};
    }
    refine(*mesh_, ball, work_.candidates.view(), work_.hits);
  }
  const PolytopeStatus status =
      polytope_.around(tip, radius, options_.margin, work_.hits.view(), work_.planes);
  return {status, work_.planes.view()};
}

}  // namespace keepout
