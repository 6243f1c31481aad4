// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "keepout/activation/activation_rule.h"
#include "keepout/activation/free_polytope.h"
#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"
#include "keepout/step/motion.h"
#include "keepout/step/options.h"
#include "keepout/step/side_watch.h"
#include "keepout/step/solver.h"
#include "keepout/step/tip_monitor.h"

namespace keepout {

class TipMemory;

/// The treatment of a tip that starts on the forbidden side. Use escape with the certified rule
/// only.
enum class Inside : std::uint8_t {
  escape,       // escapes straight through the nearest point of the surface, before anything else
  taken_as_is,  // is not classified: the tip maintains its clearance on the side where it is
  led_out [[deprecated("use escape")]] = escape
};

/// The names of Inside.
inline constexpr std::array<std::string_view, 2> inside_names{"escape", "taken_as_is"};

/// Planes that bound the free space around a tip.
struct Polytope {
  Status status = Status::invalid_input;  // free if the planes are complete
  std::span<const HalfSpace> planes;      // unless ok(), they allow only zero motion

  /// Returns true if the planes are complete.
  bool ok() const noexcept { return is_ok(status); }
  /// Returns one line on what happened and what to do about it; a string literal.
  std::string_view reason() const noexcept { return keepout::reason(status, Subject::polytope); }
};

/// Keeps a tool tip out of a mesh: combines an index, an activation rule (`rule` for short) and a
/// solver, with their memory. Examples call an object of this type `guard`.
///
///     target -> trial -> rule <-> index traversal -> accepted: step
///                 ^        |
///                 |        v
///                 +-- solver <- planes
///
/// This is the default loop, with the certified rule on a WideBvh. The first trial is the target
/// itself, without planes. The index shows the rule the triangles in the way of each trial
/// (MotionTraversal). The rule accepts the trial or adds a plane, and the solver finds the next
/// trial within the planes. Other indices and rules use exact hits instead: the index proposes
/// candidates, and the exact kernel selects the hits in the region (Neighborhood).
///
/// Not thread-safe: make one for each control loop. Mesh and index may be shared.
///
/// On a watertight mesh with Inside::escape, a step first classifies the tip as inside or outside,
/// unless the tip is on the path of the last step. Certified steps never change the side.
class MotionConstraint {
 public:
  /// Combines the parts, and allocates all memory. The index must be built on `mesh`; other motion
  /// constraints, also of other threads, may share it. Rule and solver must not be shared. Unlike
  /// make_motion_constraint, this does not classify tips by default. Throws Error if a part is
  /// missing, if the index is for another mesh, or if the mesh, an option or a capacity is out of
  /// range. Also throws Error for Inside::escape with a rule that guards a whole tool.
  MotionConstraint(std::shared_ptr<const Mesh> mesh, std::shared_ptr<const SpatialIndex> index,
                   std::unique_ptr<ActivationRule> rule, std::unique_ptr<Solver> solver,
                   const StepOptions& options, const Capacity& capacity = {},
                   Inside inside = Inside::taken_as_is);
  /// Moves. The source may only be destroyed or assigned to.
  MotionConstraint(MotionConstraint&&) noexcept;
  /// Like the move constructor.
  MotionConstraint& operator=(MotionConstraint&&) noexcept;
  ~MotionConstraint();

  /// Runs one control cycle: returns the nearest motion that the rule and the guides allow. The
  /// result's views stay valid until the next step. Does not allocate or throw. On failure the
  /// motion is zero and the status gives the cause.
  Step step(const Motion& request) noexcept { return step(request, side_watch_, nullptr); }

  /// Like step(request), but also measures the time of each stage of the cycle. The opening of
  /// guides, the classification of the tip, an escape and a search for the distance
  /// (Distances::always) belong to no stage.
  Step step(const Motion& request, StageTimes& times) noexcept {
    return step(request, side_watch_, &times);
  }

  /// Like step(request), for one of several tips. Each tip has its own SideWatch, and gets the
  /// results that its own MotionConstraint would return.
  Step step(const Motion& request, SideWatch& sides) noexcept {
    return step(request, sides, nullptr);
  }

  /// Returns the free space around a tip as one convex polytope, for a caller's own quadratic
  /// program, predictive controller or sampler. Every motion within all planes and within `radius`
  /// maintains the required clearance; guarantee and failures: FreePolytope. The planes stay valid
  /// until the next call. After a failure they allow only zero motion. The status is `inside` for a
  /// tip on the forbidden side, unless tips are not classified (Inside::taken_as_is, or an open
  /// mesh). It is `unsupported` for a rule that guards a whole tool, and if there are guides,
  /// because the planes do not include them.
  Polytope free_polytope(const Vec3& tip, double radius) noexcept;

  /// Follows anatomy that has moved: continues with a mesh and its index. The index may be the
  /// present one after a refit, or one built elsewhere meanwhile. Prepares the rule again; all tips
  /// are classified again. If tips are not classified (an open mesh, or Inside::taken_as_is), a
  /// surface that moved over a tip is not detected. After a refit, step() returns mesh_changed
  /// until this is called. Throws Error, and changes nothing, if the index is for another mesh or
  /// the mesh is out of range. Allocates: not for the control path.
  void follow(std::shared_ptr<const Mesh> moved, std::shared_ptr<const SpatialIndex> index);

  /// Returns true if the index matches the mesh. False from a refit until follow(), and after a
  /// follow() in which the rule threw an Error.
  bool is_current() const noexcept { return is_prepared_ && neighborhood_->is_current(); }

  /// Returns the work units that the last step or polytope spent: see Budget. The limit is
  /// Capacity::work_units.
  std::size_t work_units() const noexcept { return budget_->spent(); }
  /// Returns work_units().
  [[deprecated("use work_units()")]] std::size_t looks() const noexcept { return work_units(); }

  /// Replaces the guides from the next step on: see Guide. They share the cycle's work budget with
  /// the mesh. Throws Error, and changes nothing, for more guides than Guide::most or a guide of a
  /// link. Allocates: not for the control path.
  void set_guides(std::vector<Guide> guides);

  /// Returns the guides.
  std::span<const Guide> guides() const noexcept;

  /// Sets a monitor, which must confirm each motion from the next step on, or removes it (nullptr).
  /// A step whose motion it does not confirm is `unconfirmed`. The monitor must already have the
  /// present mesh; follow() passes it each new one. For an escape, the monitor confirms where the
  /// tip starts, because no clearance is promised. Throws Error, and changes nothing, if the rule
  /// guards a whole tool.
  void set_monitor(std::unique_ptr<TipMonitor> monitor);

  /// Forgets the last step, so that the next tip is classified again at any position. For motions
  /// that do not continue each other.
  void forget() noexcept { side_watch_.forget(); }

  /// Returns the mesh.
  const Mesh& mesh() const noexcept { return neighborhood_->mesh(); }

  /// Returns the index of the mesh.
  const SpatialIndex& index() const noexcept { return neighborhood_->index(); }

  /// Returns the ball in which the rule first searches for triangles. Precondition: the request is
  /// valid.
  Ball region(const Motion& request) const noexcept;

  /// Returns true if a step queries the index for all triangles in the region; false if it uses a
  /// faster search of the index.
  bool makes_queries() const noexcept { return rule_->makes_queries(); }

  /// Returns true if the rule guards a convex tool, which has the axes of the mesh.
  bool guards_a_tool() const noexcept { return rule_->guards_a_tool(); }

  /// Returns the options.
  const StepOptions& options() const noexcept { return options_; }

  /// Returns the capacity.
  const Capacity& capacity() const noexcept { return capacity_; }

  /// Sets the options from the next step on. The side of the tip is remembered. Throws Error, and
  /// changes nothing, for options that the constructor would refuse, or for more nodes than
  /// Capacity::nodes.
  void set_options(const StepOptions& options);

 private:
  Step step(const Motion& request, SideWatch& sides, StageTimes* times) noexcept;
  Step escape_or_cycle(const Motion& request, SideWatch& sides, StageTimes* times) noexcept;
  using Confirms = bool (TipMonitor::*)(const Vec3&, const Vec3&, const StepOptions&) noexcept;
  Step confirmed(Step step, const Vec3& tip, Confirms confirms, StageTimes* times) const noexcept;
  bool classifies(const SideWatch& sides) const noexcept { return has_sides_ && sides.is_on(); }
  void prepare();
  void reserve_solver(std::size_t guides);
  void require_usable(const StepOptions& options);

  StepOptions options_;
  Capacity capacity_;
  std::unique_ptr<Budget> budget_;              // of a cycle
  std::unique_ptr<Neighborhood> neighborhood_;  // the rule refers to it, so it never moves
  std::unique_ptr<ActivationRule> rule_;
  std::unique_ptr<Solver> solver_;
  std::unique_ptr<TipMemory> memory_;
  FreePolytope polytope_;
  HalfSpaceBuffer polytope_planes_;
  bool is_prepared_ = false;
  Inside inside_;
  bool has_sides_;                       // the mesh is watertight, and tips inside escape
  std::unique_ptr<TipMonitor> monitor_;  // or null
  SideWatch side_watch_;  // of the tip that is stepped without a SideWatch of its own
};

}  // namespace keepout
