// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/motion_constraint.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "keepout/error.h"
#include "keepout/index/nearest.h"
#include "keepout/mesh/watertight.h"

namespace keepout {
namespace {

void require_in_range(const StepOptions& options) {
  if (!is_ok(check({.tip = Vec3::Zero(), .desired = Vec3::Zero()}, options))) {
    throw Error(
        "the radius must be above zero and not lost beside the margin; tool radius, margin, "
        "damping, recovery, depth, refinements and nodes not below zero; no length above 1e30");
  }
}

/// No query finds more triangles than there are. Throws before any memory is asked for.
Capacity fitted(Capacity capacity, const Mesh* mesh, const StepOptions& options) {
  constexpr std::size_t most = std::numeric_limits<int>::max();
  if (mesh == nullptr) {
    throw Error("a motion constraint needs a mesh, an index, an activation rule and a solver");
  }
  if (capacity.planes > most / 2 || capacity.variables > most || capacity.extra_rows > most / 2) {
    throw Error("a capacity of more than 2^30 planes or rows cannot be held");
  }
  require_in_range(options);
  capacity.nodes = std::max(capacity.nodes, static_cast<std::size_t>(std::max(options.nodes, 0)));
  capacity.triangles = std::min(capacity.triangles, mesh->triangle_count());
  return capacity;
}

}  // namespace

MotionConstraint::MotionConstraint(std::shared_ptr<const Mesh> mesh,
                                   std::shared_ptr<const SpatialIndex> index,
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
      polytope_planes_(std::max(work_.planes.capacity(), planes_to_hold_still)),
      watch_(inside == Inside::led_out && is_watertight(*mesh_)),
      sides_(new_watch()) {
  if (!index_ || !activation_ || !solver_) {
    throw Error("a motion constraint needs a mesh, an index, an activation rule and a solver");
  }
  if (options_.searching) {
    if (auto faster = activation_->searching(*index_)) activation_ = std::move(faster);
  }
  if (inside == Inside::led_out && activation_->guarded() != Guarded::tip) {
    throw Error(
        "a tip that starts inside is led out without regard to the rest of a tool: with a rule "
        "that "
        "guards a whole tool, ask for Inside::taken_as_is");
  }
  require_margin(options_);
  activation_->reserve(work_.candidates.capacity());
  solver_->reserve(static_cast<int>(work_.variables()), static_cast<int>(work_.planes.capacity()) +
                                                            static_cast<int>(work_.extra_rows()));
}

void MotionConstraint::set_options(const StepOptions& options) {
  require_in_range(options);
  require_margin(options);
  options_ = options;
}

/// That rounding leaves something of the margin.
void MotionConstraint::require_margin(const StepOptions& options) {
  // At the tip nearest to the origin that there can be, where rounding is least.
  const Vec3 tip = mesh_->bounds().low.cwiseMax(Vec3::Zero()).cwiseMin(mesh_->bounds().high);
  const Surroundings around =
      surroundings_of({.tip = tip, .desired = Vec3::Zero()}, options, activation_->reach());
  work_.planes.clear();
  if (activation_->start(around, work_.planes).stance == Opening::Stance::no_margin) {
    throw Error(
        "the margin is too small for a mesh and a radius of this size: the distance kept, "
        "tool radius and margin together, must be well above 1e-9 of the longest edge and "
        "of the radius");
  }
}

Step MotionConstraint::step(const Motion& motion) noexcept { return step(motion, sides_); }

Step MotionConstraint::step(const Motion& motion, StageTimes& times) noexcept {
  Step result = keepout::step(sides_, *mesh_, *index_, *activation_, *solver_, motion, options_,
                              work_, StageClock(times));
  if (options_.distances == Distances::always) tell_distance(motion.tip, result);
  return result;
}

Step MotionConstraint::step(const Motion& motion, SideWatch& sides) noexcept {
  Step result =
      keepout::step(sides, *mesh_, *index_, *activation_, *solver_, motion, options_, work_);
  if (options_.distances == Distances::always) tell_distance(motion.tip, result);
  return result;
}

void MotionConstraint::tell_distance(const Vec3& tip, Step& step) noexcept {
  if (step.distance || step.status == Status::invalid_input) return;
  if (const auto nearest = find_nearest(*mesh_, *index_, tip, 0.0, work_.candidates)) {
    step.distance = nearest->closest.distance;
  }
}

Polytope MotionConstraint::free_polytope(const Vec3& tip, double radius) noexcept {
  if (activation_->guarded() != Guarded::tip) {
    hold_still(polytope_planes_);
    return {PolytopeStatus::whole_tool, polytope_planes_.view()};
  }
  const Ball ball{tip, radius + distance_kept(options_)};
  work_.candidates.clear();
  work_.hits.clear();
  // What is no number finds nothing, and is refused there.
  if (tip.allFinite() && ball.radius >= 0.0) {
    index_->collect(ball, work_.candidates);
    if (work_.candidates.overflowed()) {
      hold_still(polytope_planes_);
      return {PolytopeStatus::over_capacity, polytope_planes_.view()};
    }
    refine(*mesh_, ball, work_.candidates.view(), work_.hits);
  }
  const PolytopeStatus status =
      polytope_.around(tip, radius, distance_kept(options_), work_.hits.view(), polytope_planes_);
  return {status, polytope_planes_.view()};
}

}  // namespace keepout
