// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/motion_constraint.h"

#include <algorithm>
#include <utility>

#include "cycle.h"
#include "escape.h"
#include "input.h"
#include "keepout/error.h"
#include "keepout/index/query.h"
#include "keepout/mesh/doctor.h"

namespace keepout {
namespace {

void require_mesh_in_range(const Mesh& mesh) {
  const double farthest =
      std::max(mesh.bounds().low.cwiseAbs().maxCoeff(), mesh.bounds().high.cwiseAbs().maxCoeff());
  const double longest = mesh.longest_edge();
  if (farthest > longest_length || (longest > 0.0 && longest < shortest_length)) {
    throw Error(
        "the mesh is too large, too small or too far from the origin: its coordinates must be "
        "within 1e15, and its longest edge above 1e-15; bring it into a unit that suits it, as mm");
  }
}

std::unique_ptr<Neighborhood> neighborhood_of(std::shared_ptr<const Mesh> mesh,
                                              std::shared_ptr<const SpatialIndex> index,
                                              const ActivationRule* activation,
                                              const Solver* solver, const Capacity& capacity,
                                              Budget& budget) {
  if (!mesh || !index || activation == nullptr || solver == nullptr) {
    throw Error("a motion constraint needs a mesh, an index, an activation rule and a solver");
  }
  require_mesh_in_range(*mesh);
  return std::make_unique<Neighborhood>(std::move(mesh), std::move(index), capacity.triangles,
                                        budget);
}

/// Returns the capacity with room for the nodes of the options. Throws Error for options or a
/// capacity out of range.
Capacity checked(Capacity capacity, const StepOptions& options) {
  require_in_range(options);
  require_in_range(capacity_options, capacity);
  capacity.nodes = std::max(capacity.nodes, static_cast<std::size_t>(std::max(options.nodes, 0)));
  return capacity;
}

}  // namespace

std::size_t Capacity::looks_or_default(std::size_t looks, const SpatialIndex& index) {
  if (looks > 0) return looks;
  return index.walks() ? looks_of_a_walk : looks_of_queries;
}

MotionConstraint::MotionConstraint(std::shared_ptr<const Mesh> mesh,
                                   std::shared_ptr<const SpatialIndex> index,
                                   std::unique_ptr<ActivationRule> activation,
                                   std::unique_ptr<Solver> solver, const StepOptions& options,
                                   const Capacity& capacity, Inside inside)
    : options_(options),
      capacity_(checked(capacity, options)),
      budget_(std::make_unique<Budget>()),
      near_(neighborhood_of(mesh, std::move(index), activation.get(), solver.get(), capacity_,
                            *budget_)),
      activation_(std::move(activation)),
      solver_(std::move(solver)),
      work_(std::make_unique<Workspace>(capacity_, *solver_)),
      polytope_(mesh, near_->room()),
      polytope_planes_(std::max(work_->planes.capacity(), planes_to_hold_still)),
      inside_(inside),
      has_sides_(inside == Inside::led_out && is_watertight(*mesh)) {
  if (inside == Inside::led_out && activation_->guards_a_tool()) {
    throw Error(
        "a tip that starts inside is led out without regard to the rest of a tool: with a rule "
        "that guards a whole tool, ask for Inside::taken_as_is");
  }
  prepare();
  reserve_solver(0);
  require_usable(options_);
}

void MotionConstraint::reserve_solver(std::size_t guides) {
  const std::size_t of_guides = guides * TipGuides::most_planes_of_a_guide;
  solver_->reserve(static_cast<int>(std::max<std::size_t>(capacity_.variables, 3)),
                   static_cast<int>(capacity_.planes + of_guides + capacity_.extra_rows));
}

/// Prepares the rule and the work budget for the mesh and its index.
void MotionConstraint::prepare() {
  is_prepared_ = false;
  *budget_ = Budget(Capacity::looks_or_default(capacity_.looks, index()));
  activation_->prepare(*near_);
  is_prepared_ = true;
}

void MotionConstraint::follow(std::shared_ptr<const Mesh> moved,
                              std::shared_ptr<const SpatialIndex> index) {
  auto near = neighborhood_of(moved, std::move(index), activation_.get(), solver_.get(), capacity_,
                              *budget_);
  FreePolytope polytope(moved, near->room());
  const bool has_same_triangles = std::ranges::equal(moved->triangles(), mesh().triangles());
  if (!has_same_triangles) has_sides_ = inside_ == Inside::led_out && is_watertight(*moved);
  *near_ = std::move(*near);
  polytope_ = std::move(polytope);
  forget();
  prepare();
}

MotionConstraint::MotionConstraint(MotionConstraint&&) noexcept = default;
MotionConstraint& MotionConstraint::operator=(MotionConstraint&&) noexcept = default;
MotionConstraint::~MotionConstraint() = default;

void MotionConstraint::set_options(const StepOptions& options) {
  require_usable(options);
  options_ = options;
}

void MotionConstraint::set_guides(std::vector<Guide> guides) {
  TipGuides prepared(std::move(guides));
  reserve_solver(prepared.guides().size());
  work_->guides = std::move(prepared);
}

std::span<const Guide> MotionConstraint::guides() const noexcept { return work_->guides.guides(); }

/// Throws Error for options out of range, and if the rule finds the margin too small beside its
/// rounding. Opens a cycle to ask the rule.
void MotionConstraint::require_usable(const StepOptions& options) {
  require_in_range(options);
  if (static_cast<std::size_t>(options.nodes) > capacity_.nodes) {
    throw Error("more nodes than room was made for: see Capacity::nodes");
  }
  // At the tip nearest to the origin, where rounding is least.
  const Box& bounds = mesh().bounds();
  budget_->renew();
  const Vec3 tip = bounds.low.cwiseMax(Vec3::Zero()).cwiseMin(bounds.high);
  const CycleProblem problem =
      cycle_problem_of({.tip = tip, .desired = Vec3::Zero()}, options, activation_->end_region());
  work_->planes.clear();
  const bool fits = activation_->gather(problem);
  const Opening opening = activation_->open(problem, work_->planes);
  if (fits && opening.status == Status::margin_too_small) {
    throw Error(
        "the margin is too small for a mesh and a radius of this size: the distance kept, "
        "tool radius and margin together, must be well above 1e-9 of the longest edge and "
        "of the radius");
  }
}

Ball MotionConstraint::region(const Motion& request) const noexcept {
  return activation_->region(cycle_problem_of(request, options_, activation_->end_region()));
}

Step MotionConstraint::step(const Motion& request, SideWatch& sides, StageTimes* times) noexcept {
  Step result;
  if (times != nullptr) *times = {};
  if (!is_current()) {
    result.status = Status::mesh_changed;
    return result;
  }
  budget_->renew();
  // A refused request does not change what is known of the tip.
  if (const std::optional<Status> refused = refusal(request, options_)) {
    result.status = *refused;
  } else {
    step_checked(request, sides, times, result);
    if (TipGuides& guides = work_->guides; !guides.empty()) {
      result.guides = guides.states(result.relaxation);
      if (result.ok() && guides.is_recovering()) result.status = Status::recovering;
    }
  }
  if (!result.ok()) add_cause(result.status, result.limits);
  const bool is_missing = options_.distances == Distances::always && !result.distance;
  if (is_missing && result.status != Status::invalid_input) {
    const auto nearest = find_nearest(*near_, request.tip);
    if (nearest) result.distance = nearest->closest.distance;
  }
  return result;
}

/// Steps a tip: an escape on the forbidden side, else a cycle. After an escape, or if the tip could
/// not be classified, the next tip must be classified again: nothing is noted.
void MotionConstraint::step_checked(const Motion& request, SideWatch& sides, StageTimes* times,
                                    Step& result) noexcept {
  if (!work_->guides.empty()) work_->guides.open(request.tip, options_.recovery);
  if (classifies(sides) && sides.must_classify(request.tip, mesh()) &&
      escape_if_inside(*near_, request, options_, *work_, result)) {
    return;
  }
  Cycle(*activation_, *solver_, *work_, *budget_, options_, request, times).run(result);
  if (result.status == Status::touching && classifies(sides) &&
      escape_from_surface(*near_, request, options_, *work_, result)) {
    return;
  }
  sides.after(request, result, options_, mesh());
}

Polytope MotionConstraint::free_polytope(const Vec3& tip, double radius) noexcept {
  Status status = Status::unsupported;
  if (!is_current()) {
    status = Status::mesh_changed;
  } else if (!activation_->guards_a_tool()) {
    budget_->renew();
    const double kept = required_clearance(options_);
    // around() reports a ball that is not valid.
    const bool fits = near_->gather({tip, radius + kept}) || !(radius >= 0.0 && tip.allFinite());
    status = fits ? polytope_.around(tip, radius, kept, near_->hits(), *budget_, polytope_planes_)
                  : budget_->status_at_end();
  }
  if (status != Status::free) hold_still(polytope_planes_);
  return {status, polytope_planes_.view()};
}

}  // namespace keepout
