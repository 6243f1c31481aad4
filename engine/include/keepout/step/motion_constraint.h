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

namespace keepout {

class TipMemory;

/// The treatment of a tip that starts on the forbidden side. For the certified rule.
enum class Inside : std::uint8_t {
  escape,      // escapes straight through the nearest point of the surface, before anything else
  taken_as_is  // is not classified: the tip keeps its clearance on whichever side it is
};

/// The names of Inside.
inline constexpr std::array<std::string_view, 2> inside_names{"escape", "taken_as_is"};

/// Planes around a tip.
struct Polytope {
  Status status = Status::invalid_input;  // free if the planes are complete
  std::span<const HalfSpace> planes;      // unless ok(), they allow standing still only

  /// Whether the planes are complete.
  bool ok() const noexcept { return is_ok(status); }
  /// One line on what happened and what to do about it; a literal.
  std::string_view reason() const noexcept { return keepout::reason(status, Subject::polytope); }
};

/// Keeps a tool tip out of a mesh: puts an index, an activation rule (`rule` for short) and a
/// solver together, with their memory. Every step of a tip runs through here. Examples call an
/// object of this type `guard`.
///
///     target -> trial -> rule <-> index traversal -> accepted: step
///                 ^        |
///                 |        v
///                 +-- solver <- planes
///
/// This is the loop by default, under the rule certified on a WideBvh. The first trial is the
/// target itself, without planes. The index shows the rule the triangles in the way of each trial
/// (MotionTraversal). The rule accepts the trial, or adds a plane, and the solver finds the next
/// trial within the planes. Other indices and rules work on exact hits instead: the index proposes
/// candidates, and the exact kernel keeps those in the region (Neighborhood).
///
/// Not thread-safe: one for each control loop; mesh and index may be shared.
///
/// On a watertight mesh with Inside::escape, a tip that the last step did not move there is
/// classified as inside or outside. From there on no certified step changes sides.
class MotionConstraint {
 public:
  /// The index must be built on `mesh`. It may be shared with other motion constraints,
  /// of other threads too; rule and solver may not. Throws Error when a part is missing, when the
  /// index is of another mesh, when the mesh, an option or a capacity is out of range, and when
  /// tips are to be led out under a rule that guards a whole tool. Makes all memory here.
  /// Unlike make_motion_constraint, whose default is Inside::escape, this does not classify tips
  /// unless `inside` says so.
  MotionConstraint(std::shared_ptr<const Mesh> mesh, std::shared_ptr<const SpatialIndex> index,
                   std::unique_ptr<ActivationRule> rule, std::unique_ptr<Solver> solver,
                   const StepOptions& options, const Capacity& capacity = {},
                   Inside inside = Inside::taken_as_is);
  /// Takes over all that another one has, which may then only be destroyed or assigned to.
  MotionConstraint(MotionConstraint&&) noexcept;
  /// Like the move constructor.
  MotionConstraint& operator=(MotionConstraint&&) noexcept;
  ~MotionConstraint();

  /// Runs one control cycle: returns the nearest motion that the rule and the guides allow. The
  /// result's views stay valid until the next step. Allocates nothing, throws nothing. On failure
  /// the motion is zero and the status gives the cause.
  Step step(const Motion& request) noexcept { return step(request, side_watch_, nullptr); }

  /// Like step(request), but also measures the time of each stage of the cycle. The opening of
  /// guides, the classification of the tip, an escape and a search for the distance
  /// (Distances::always) belong to no stage.
  Step step(const Motion& request, StageTimes& times) noexcept {
    return step(request, side_watch_, &times);
  }

  /// Like step(request), for one of several tips that are stepped in turn: each has a SideWatch of
  /// its own, and gets the answers that a MotionConstraint of its own would give.
  Step step(const Motion& request, SideWatch& sides) noexcept {
    return step(request, sides, nullptr);
  }

  /// The free space around a tip as one convex polytope, whatever the direction of the motion: for
  /// a caller's own QP, MPC or sampler. Every motion that stays within all planes and within
  /// `radius` keeps the margin; guarantee and failures: FreePolytope. The planes stay valid until
  /// the next call; a failure allows standing still only. The tip is not classified: around a tip
  /// inside it is the space inside. With a rule that guards a whole tool it is refused.
  Polytope free_polytope(const Vec3& tip, double radius) noexcept;

  /// Continues with anatomy that has moved: with a mesh and an index of it, which may be the
  /// present one, refit, or one that was prepared elsewhere in the meantime. Prepares the rule
  /// again, and all tips are classified again. It is not detected that a surface has moved over a
  /// tip that is not classified: beside an open mesh, or with Inside::taken_as_is. Once an index is
  /// refit, every step is `mesh_changed` until this is called. Allocates, and is not for the
  /// control path. Throws Error, and stays as it is, if the index is not of this mesh, or the mesh
  /// out of range.
  void follow(std::shared_ptr<const Mesh> moved, std::shared_ptr<const SpatialIndex> index);

  /// Returns true if the index is of the mesh that the tip is kept out of: false from a refit until
  /// follow(), and after a follow() that threw an Error of the rule.
  bool is_current() const noexcept { return is_prepared_ && neighborhood_->is_current(); }

  /// Returns the work units that the last step or polytope spent: see Budget. The most that
  /// it may spend: Capacity::work_units.
  std::size_t work_units() const noexcept { return budget_->spent(); }
  /// Returns work_units().
  [[deprecated("use work_units()")]] std::size_t looks() const noexcept { return work_units(); }

  /// Keeps the tip in these guides' regions as well from the next step on, instead of those that
  /// there are: see Guide. Within the same cycle and work budget as the mesh. Throws Error, and
  /// changes nothing, for more than Guide::most or a guide of a link. Allocates, and is not for the
  /// control path.
  void set_guides(std::vector<Guide> guides);

  /// Returns the guides.
  std::span<const Guide> guides() const noexcept;

  /// Forgets where the last step ended, so that the next tip is classified again however near it
  /// is, as at the start: for motions that have nothing to do with each other.
  void forget() noexcept { side_watch_.forget(); }

  /// Returns the mesh that the tip is kept out of.
  const Mesh& mesh() const noexcept { return neighborhood_->mesh(); }

  /// Returns the index of the mesh.
  const SpatialIndex& index() const noexcept { return neighborhood_->index(); }

  /// Returns the ball in which the rule searches for triangles at first. Precondition: the request
  /// is valid.
  Ball region(const Motion& request) const noexcept;

  /// Returns true if a step asks the index for all triangles in the region, and not by something
  /// faster that the index offers for the rule.
  bool makes_queries() const noexcept { return rule_->makes_queries(); }

  /// Returns the options: radius, tool radius and margin, among others.
  const StepOptions& options() const noexcept { return options_; }

  /// Returns the capacity for the largest step.
  const Capacity& capacity() const noexcept { return capacity_; }

  /// Behaves so from the next step on. Where the last step led is remembered. Throws Error, and
  /// changes nothing, for options that the constructor would refuse, or for more nodes than there
  /// is room for.
  void set_options(const StepOptions& options);

 private:
  Step step(const Motion& request, SideWatch& sides, StageTimes* times) noexcept;
  Step escape_or_cycle(const Motion& request, SideWatch& sides, StageTimes* times) noexcept;
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
  bool has_sides_;        // the mesh is watertight, and tips inside escape
  SideWatch side_watch_;  // of the tip that is stepped without one of its own
};

}  // namespace keepout
