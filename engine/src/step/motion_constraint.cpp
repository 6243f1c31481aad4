// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/motion_constraint.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "cycle.h"
#include "input.h"
#include "keepout/error.h"
#include "keepout/index/query.h"
#include "keepout/mesh/doctor.h"
#include "placement.h"

namespace keepout {
namespace {

void require_in_range(const StepOptions& options) {
  if (!is_ok(check({.tip = Vec3::Zero(), .desired = Vec3::Zero()}, options))) {
    throw Error(
        "the radius must be above zero and not lost beside the margin; tool radius, margin, "
        "damping, recovery, depth, refinements and nodes not below zero; no length above 1e30");
  }
}

std::unique_ptr<Neighborhood> neighborhood_of(std::shared_ptr<const Mesh> mesh,
                                              std::shared_ptr<const SpatialIndex> index,
                                              const Activation* activation, const Solver* solver,
                                              const Capacity& capacity) {
  if (!mesh || !index || activation == nullptr || solver == nullptr) {
    throw Error("a motion constraint needs a mesh, an index, an activation rule and a solver");
  }
  return std::make_unique<Neighborhood>(std::move(mesh), std::move(index), capacity.triangles);
}

/// Throws for what cannot be held.
Capacity checked(Capacity capacity, const StepOptions& options) {
  require_in_range(options);
  constexpr std::size_t most = std::numeric_limits<int>::max();
  if (capacity.planes > most / 2 || capacity.variables > most || capacity.extra_rows > most / 2) {
    throw Error("a capacity of more than 2^30 planes or rows cannot be held");
  }
  capacity.nodes = std::max(capacity.nodes, static_cast<std::size_t>(std::max(options.nodes, 0)));
  return capacity;
}

}  // namespace

MotionConstraint::MotionConstraint(std::shared_ptr<const Mesh> mesh,
                                   std::shared_ptr<const SpatialIndex> index,
                                   std::unique_ptr<Activation> activation,
                                   std::unique_ptr<Solver> solver, const StepOptions& options,
                                   const Capacity& capacity, Inside inside)
    : near_(neighborhood_of(mesh, std::move(index), activation.get(), solver.get(), capacity)),
      activation_(std::move(activation)),
      solver_(std::move(solver)),
      options_(options),
      most_nodes_(checked(capacity, options).nodes),
      work_(std::make_unique<Workspace>(checked(capacity, options), *solver_)),
      polytope_(mesh, near_->room()),
      polytope_planes_(std::max(work_->planes.capacity(), planes_to_hold_still)),
      makes_queries_(false),
      watch_(inside == Inside::led_out && is_watertight(*mesh)),
      sides_(new_watch()) {
  if (inside == Inside::led_out && activation_->guards_a_tool()) {
    throw Error(
        "a tip that starts inside is led out without regard to the rest of a tool: with a rule "
        "that guards a whole tool, ask for Inside::taken_as_is");
  }
  activation_->prepare(*near_);
  solver_->reserve(static_cast<int>(std::max<std::size_t>(capacity.variables, 3)),
                   static_cast<int>(capacity.planes + capacity.extra_rows));
  require_usable(options_);
  makes_queries_ = near_->ball().radius >= 0.0;  // once it has been asked at all
}

MotionConstraint::MotionConstraint(MotionConstraint&&) noexcept = default;
MotionConstraint& MotionConstraint::operator=(MotionConstraint&&) noexcept = default;
MotionConstraint::~MotionConstraint() = default;

void MotionConstraint::set_options(const StepOptions& options) {
  require_usable(options);
  options_ = options;
}

/// In range, and so that rounding leaves something of the margin.
void MotionConstraint::require_usable(const StepOptions& options) {
  require_in_range(options);
  if (static_cast<std::size_t>(options.nodes) > most_nodes_) {
    throw Error("more nodes than room was made for: see Capacity::nodes");
  }
  // At the tip nearest to the origin that there can be, where rounding is least.
  const Box& bounds = mesh().bounds();
  const Vec3 tip = bounds.low.cwiseMax(Vec3::Zero()).cwiseMin(bounds.high);
  const Surroundings around =
      surroundings_of({.tip = tip, .desired = Vec3::Zero()}, options, activation_->reach());
  work_->planes.clear();
  const bool fits = activation_->look_around(around);
  const Opening opening = activation_->start(around, work_->planes);
  if (fits && opening.status == Status::margin_too_small) {
    throw Error(
        "the margin is too small for a mesh and a radius of this size: the distance kept, "
        "tool radius and margin together, must be well above 1e-9 of the longest edge and "
        "of the radius");
  }
}

Ball MotionConstraint::region(const Motion& motion) const noexcept {
  return activation_->region(surroundings_of(motion, options_, activation_->reach()));
}

Step MotionConstraint::step(const Motion& motion) noexcept { return step(motion, sides_, nullptr); }

Step MotionConstraint::step(const Motion& motion, StageTimes& times) noexcept {
  return step(motion, sides_, &times);
}

Step MotionConstraint::step(const Motion& motion, SideWatch& sides) noexcept {
  return step(motion, sides, nullptr);
}

Step MotionConstraint::step(const Motion& motion, SideWatch& sides, StageTimes* times) noexcept {
  Step result;
  if (times != nullptr) *times = {};
  result.status = check(motion, options_);
  // What is refused says nothing of where the tip is.
  if (is_ok(result.status)) step_as_checked(motion, sides, times, result);
  const bool is_asked = options_.distances == Distances::always && !result.distance;
  if (is_asked && result.status != Status::invalid_input) {
    const auto nearest =
        find_nearest(near_->mesh(), near_->index(), motion.tip, 0.0, near_->candidates());
    if (nearest) result.distance = nearest->closest.distance;
  }
  return result;
}

/// A tip on the forbidden side is led out; any other steps as the rule allows.
void MotionConstraint::step_as_checked(const Motion& motion, SideWatch& sides, StageTimes* times,
                                       Step& result) noexcept {
  if (sides.has_to_place(motion.tip) &&
      lead_out_from_inside(*near_, motion, options_, *work_, result)) {
    return;
  }
  Cycle(*activation_, *solver_, *work_, options_, motion, times).run(result);
  if (result.status == Status::touching && sides.is_on() &&
      lead_off_surface(*near_, motion, options_, *work_, result)) {
    return;
  }
  sides.after(motion, result, options_);
}

Polytope MotionConstraint::free_polytope(const Vec3& tip, double radius) noexcept {
  PolytopeStatus status = PolytopeStatus::whole_tool;
  if (!activation_->guards_a_tool()) {
    // What is no number finds nothing, and is refused there.
    const double kept = distance_kept(options_);
    const bool fits = near_->look({tip, radius + kept}) || !near_->candidates().overflowed();
    status = fits ? polytope_.around(tip, radius, kept, near_->hits(), polytope_planes_)
                  : PolytopeStatus::over_capacity;
  }
  if (status != PolytopeStatus::found) hold_still(polytope_planes_);
  return {status, polytope_planes_.view()};
}

}  // namespace keepout
