// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/motion_constraint.h"

#include <algorithm>
#include <string>
#include <utility>

#include "cycle.h"
#include "escape.h"
#include "input.h"
#include "keepout/error.h"
#include "keepout/index/query.h"
#include "keepout/mesh/diagnostics.h"
#include "keepout/rounding_mode.h"

namespace keepout {
namespace {

void require_mesh_in_range(const Mesh& mesh) {
  const double farthest =
      std::max(mesh.bounds().low.cwiseAbs().maxCoeff(), mesh.bounds().high.cwiseAbs().maxCoeff());
  const double longest = mesh.longest_edge();
  if (farthest > longest_length || (longest > 0.0 && longest < shortest_length)) {
    throw Error(
        "the mesh is too large, too small or too far from the origin: its coordinates must be "
        "within 1e15, and its longest edge above 1e-15; scale it to another unit, such as mm");
  }
}

/// Makes the neighborhood. It is the first member made, so it also checks that rule and solver
/// exist.
std::unique_ptr<Neighborhood> neighborhood_of(std::shared_ptr<const Mesh> mesh,
                                              std::shared_ptr<const SpatialIndex> index,
                                              const ActivationRule* rule, const Solver* solver,
                                              const Capacity& capacity, Budget& budget) {
  if (!mesh || !index || rule == nullptr || solver == nullptr) {
    throw Error("a motion constraint needs a mesh, an index, an activation rule and a solver");
  }
  require_rounding_to_nearest();
  require_mesh_in_range(*mesh);
  // One more than the budget pays for: collecting so many spends it.
  const std::size_t paid =
      Capacity::work_units_or_default(capacity.work_units, *index) / work::hit + 1;
  return std::make_unique<Neighborhood>(std::move(mesh), std::move(index),
                                        std::min(capacity.triangles, paid), budget);
}

/// Returns the capacity, enlarged for the nodes of the options. Throws Error for options or a
/// capacity out of range.
Capacity checked(Capacity capacity, const StepOptions& options) {
  require_in_range(options);
  require_in_range(capacity_options, capacity);
  capacity.nodes = std::max(capacity.nodes, static_cast<std::size_t>(std::max(options.nodes, 0)));
  if (capacity.work_units == 0) capacity.work_units = capacity.looks;
  return capacity;
}

}  // namespace

std::size_t Capacity::work_units_or_default(std::size_t work_units, const SpatialIndex& index) {
  if (work_units > 0) return work_units;
  return index.traverses() ? work_units_of_traversals : work_units_of_queries;
}

MotionConstraint::MotionConstraint(std::shared_ptr<const Mesh> mesh,
                                   std::shared_ptr<const SpatialIndex> index,
                                   std::unique_ptr<ActivationRule> rule,
                                   std::unique_ptr<Solver> solver, const StepOptions& options,
                                   const Capacity& capacity, Inside inside)
    : options_(options),
      capacity_(checked(capacity, options)),
      budget_(std::make_unique<Budget>()),
      neighborhood_(
          neighborhood_of(mesh, std::move(index), rule.get(), solver.get(), capacity_, *budget_)),
      rule_(std::move(rule)),
      solver_(std::move(solver)),
      memory_(std::make_unique<TipMemory>(capacity_, *solver_)),
      polytope_(mesh, neighborhood_->room()),
      polytope_planes_(std::max(memory_->planes.capacity(), planes_to_hold_still)),
      inside_(inside),
      has_sides_(inside == Inside::escape && is_watertight(*mesh)) {
  if (inside == Inside::escape && rule_->guards_a_tool()) {
    throw Error(
        "a tip that starts inside escapes without regard to the rest of a tool: with a rule "
        "that guards a whole tool, use Inside::taken_as_is");
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
  *budget_ = Budget(Capacity::work_units_or_default(capacity_.work_units, index()));
  rule_->prepare(*neighborhood_);
  is_prepared_ = true;
}

void MotionConstraint::follow(std::shared_ptr<const Mesh> moved,
                              std::shared_ptr<const SpatialIndex> index) {
  auto near =
      neighborhood_of(moved, std::move(index), rule_.get(), solver_.get(), capacity_, *budget_);
  FreePolytope polytope(moved, near->room());
  const bool has_same_triangles = std::ranges::equal(moved->triangles(), mesh().triangles());
  if (monitor_ != nullptr) monitor_->follow(moved);
  if (!has_same_triangles) has_sides_ = inside_ == Inside::escape && is_watertight(*moved);
  *neighborhood_ = std::move(*near);
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
  memory_->guides = std::move(prepared);
}

void MotionConstraint::set_monitor(std::unique_ptr<TipMonitor> monitor) {
  if (monitor != nullptr && rule_->guards_a_tool()) {
    throw Error("a monitor confirms the motions of a ball: the rule guards a whole tool");
  }
  monitor_ = std::move(monitor);
}

std::span<const Guide> MotionConstraint::guides() const noexcept {
  return memory_->guides.guides();
}

/// Throws Error for options out of range, and if the rule finds the margin too small beside its
/// rounding. Opens a cycle to ask the rule.
void MotionConstraint::require_usable(const StepOptions& options) {
  require_in_range(options);
  if (static_cast<std::size_t>(options.nodes) > capacity_.nodes) {
    throw Error("nodes: expected at most " + std::to_string(capacity_.nodes) +
                " (Capacity::nodes), got " + std::to_string(options.nodes));
  }
  // Rounding is least at the point of the mesh's box that is nearest to the origin.
  const Box& bounds = mesh().bounds();
  budget_->renew();
  const Vec3 tip = bounds.low.cwiseMax(Vec3::Zero()).cwiseMin(bounds.high);
  const RuleInput input =
      rule_input_of({.tip = tip, .desired = Vec3::Zero()}, options, rule_->end_region());
  memory_->planes.clear();
  if (!rule_->gather(input)) return;
  if (rule_->open(input, memory_->planes).status == Status::margin_too_small) {
    throw Error(
        "the margin is too small for a mesh and a radius of this size: margin " +
        text_of(options.margin) + " and tool_radius " + text_of(options.tool_radius) +
        " together must be well above 1e-9 of the longest edge and of the radius, which is " +
        text_of(options.radius) + ": raise the margin or the tool_radius");
  }
}

Ball MotionConstraint::region(const Motion& request) const noexcept {
  return rule_->region(rule_input_of(request, options_, rule_->end_region()));
}

Step MotionConstraint::step(const Motion& request, SideWatch& sides, StageTimes* times) noexcept {
  const RoundingToNearest rounding;
  if (times != nullptr) *times = {};
  if (!is_current()) return {.status = Status::mesh_changed};
  budget_->renew();
  Step step;
  // A refused request does not change what is known about the tip.
  if (const std::optional<Status> refused = refusal(request, options_)) {
    step.status = *refused;
  } else {
    step = escape_or_cycle(request, sides, times);
    if (TipGuides& guides = memory_->guides; !guides.empty()) {
      step.guides = guides.states(step.relaxation);
      if (step.ok() && guides.is_recovering()) step.status = Status::recovering;
    }
  }
  if (!step.ok()) add_limit_of(step.status, step.limits);
  const bool is_missing = options_.distances == Distances::always && !step.distance;
  if (is_missing && step.status != Status::invalid_input) {
    const auto nearest = find_nearest(*neighborhood_, request.tip);
    if (nearest) step.distance = nearest->closest.distance;
  }
  return step;
}

/// Returns the step of a valid request: an escape of a tip on the forbidden side, else a cycle.
/// Only a cycle notes where the tip has moved. So a tip that escaped, or that could not be
/// classified, is classified again in the next step.
Step MotionConstraint::escape_or_cycle(const Motion& request, SideWatch& sides,
                                       StageTimes* times) noexcept {
  memory_->guides.open(request.tip, options_.recovery);
  if (classifies(sides) && sides.must_classify(request.tip, mesh())) {
    if (auto inside = step_of_tip_inside(*neighborhood_, request, options_, *memory_))
      return *inside;
  }
  Step step = Cycle(*rule_, *solver_, *memory_, *budget_, options_, request, times).run();
  if (step.status == Status::touching && classifies(sides)) {
    if (auto escape = escape_from_surface(*neighborhood_, request, options_, *memory_))
      return *escape;
  }
  const bool must_confirm = monitor_ != nullptr && step.ok() && !step.motion.isZero(0.0);
  if (must_confirm && !monitor_->confirms(request.tip, request.tip + step.motion, options_)) {
    step.status = Status::unconfirmed;
    step.motion.setZero();
    step.increment = {};
    step.active = {};
    step.limits = {};
  }
  sides.after(request, step, options_, mesh());
  return step;
}

Polytope MotionConstraint::free_polytope(const Vec3& tip, double radius) noexcept {
  const RoundingToNearest rounding;
  Status status = Status::unsupported;
  if (!is_current()) {
    status = Status::mesh_changed;
  } else if (!rule_->guards_a_tool() && memory_->guides.empty()) {
    budget_->renew();
    const double kept = required_clearance(options_);
    // FreePolytope::around() reports an invalid ball.
    const bool fits =
        neighborhood_->gather({tip, radius + kept}) || !(radius >= 0.0 && tip.allFinite());
    status = fits ? polytope_.around(tip, radius, kept, neighborhood_->hits(), *budget_,
                                     polytope_planes_)
                  : budget_->failure();
    // The caller's motions are unknown, so no earlier classification is of use.
    if (status == Status::free && has_sides_) {
      const auto side = find_side(*neighborhood_, tip);
      if (!side)
        status = budget_->failure();
      else if (!side->is_outside)
        status = Status::inside;
    }
  }
  if (status != Status::free) hold_still(polytope_planes_);
  return {status, polytope_planes_.view()};
}

}  // namespace keepout
