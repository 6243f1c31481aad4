// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

class Workspace;

/// What becomes of a tip that starts on the forbidden side. For the certified rule.
enum class Inside : std::uint8_t {
  led_out,     // straight through the nearest point of the surface, before it may do anything else
  taken_as_is  // not asked: the surface is kept from on whichever side the tip is
};

/// Planes around a tip.
struct Polytope {
  Status status = Status::invalid_input;  // free if the planes are complete
  std::span<const HalfSpace> planes;      // unless ok(), they allow standing still only

  /// Whether the planes are complete.
  bool ok() const noexcept { return is_ok(status); }
  /// One line on what happened and what to do about it; a literal.
  std::string_view reason() const noexcept { return keepout::reason(status, Subject::polytope); }
};

/// Keeps a tool tip out of a mesh: puts an index, a rule and a solver together, with their memory.
/// Whatever steps does so through here: what is tested, timed and attacked is what runs.
///
///     mesh -> index -> candidates -> exact hits -> planes -> problem -> step
///
/// By default, under the rule certified on a WideBvh, candidates and hits are passed by: the index
/// shows the rule the triangles in the way of each motion that is tried (MotionWalk).
///
/// Not thread-safe: one for each control loop; mesh and index may be shared.
///
/// A tip that the last step did not lead to is placed anew: on a watertight mesh its side is found
/// by the winding. From there on no certified step changes sides.
class MotionConstraint {
 public:
  /// The index must be built on `mesh`. It may be shared with other motion constraints,
  /// of other threads too; rule and solver may not. Throws Error when a part is missing, when the
  /// index is of another mesh, when the mesh, an option or a capacity is out of range, and when
  /// tips are to be led out under a rule that guards a whole tool. Makes all memory here.
  MotionConstraint(std::shared_ptr<const Mesh> mesh, std::shared_ptr<const SpatialIndex> index,
                   std::unique_ptr<ActivationRule> activation, std::unique_ptr<Solver> solver,
                   const StepOptions& options, const Capacity& capacity = {},
                   Inside inside = Inside::taken_as_is);
  /// Takes over all that another one has, which is of no use any more.
  MotionConstraint(MotionConstraint&&) noexcept;
  /// The same.
  MotionConstraint& operator=(MotionConstraint&&) noexcept;
  ~MotionConstraint();

  /// The nearest motion that the rule and the guides allow: one control cycle. The result's views
  /// stay valid until the next step. Allocates nothing, throws nothing. On any trouble the motion
  /// is zero and the status says why.
  Step step(const Motion& motion) noexcept;

  /// The same, and what each stage took; not so looking for a distance, see Distances::always.
  Step step(const Motion& motion, StageTimes& times) noexcept;

  /// The same for one of several tips that are stepped in turn, with one memory: each has a
  /// SideWatch of its own, and gets the answers that a MotionConstraint of its own would give.
  Step step(const Motion& motion, SideWatch& sides) noexcept;

  /// The free space around a tip as one convex polytope, whatever the direction of the motion: for
  /// a caller's own QP, MPC or sampler. Every motion that stays within all planes and within
  /// `radius` keeps the margin; guarantee and failures: FreePolytope. The planes stay valid until
  /// the next call; a failure allows standing still only. Sides are not asked about: around a tip
  /// inside it is the space inside. With a rule that guards a whole tool it is refused.
  Polytope free_polytope(const Vec3& tip, double radius) noexcept;

  /// Goes on with anatomy that has moved: with a mesh and an index of it, which may be the one at
  /// hand, refit, or one that was made ready elsewhere in the meantime. What the rule knows is made
  /// anew, and all tips are placed anew; nothing tells whether a surface has moved over a tip whose
  /// side is not asked about: of an open mesh, or with Inside::taken_as_is. Once an index is refit,
  /// every step is `mesh_changed` until it is followed. Allocates, and is not for the control path.
  /// Throws Error, and stays as it is, if the index is not of this mesh, or the mesh out of range.
  void follow(std::shared_ptr<const Mesh> moved, std::shared_ptr<const SpatialIndex> index);

  /// Whether the index is of the mesh that is kept out of: not so from a refit until follow.
  bool is_current() const noexcept { return is_prepared_ && near_->is_current(); }

  /// How much work the last step or polytope was: see Budget and Capacity::looks.
  std::size_t looks() const noexcept { return budget_->spent(); }

  /// Keeps the tip in these guides' regions as well from the next step on, instead of those that
  /// there are: see Guide. Within the same cycle and work budget as the mesh. Throws Error, and
  /// changes nothing, for more than Guide::most or a guide of a link. Allocates, and is not for the
  /// control path.
  void set_guides(std::vector<Guide> guides);

  /// Returns the guides.
  std::span<const Guide> guides() const noexcept;

  /// Forgets where the last step led, so that the next tip is placed anew however near it is, as at
  /// the start: for motions that have nothing to do with each other.
  void forget() noexcept { sides_.forget(); }

  /// What the tip is kept out of.
  const Mesh& mesh() const noexcept { return near_->mesh(); }

  /// What is asked for triangles.
  const SpatialIndex& index() const noexcept { return near_->index(); }

  /// Where the rule looks for triangles at first. Precondition: the motion is valid.
  Ball region(const Motion& motion) const noexcept;

  /// Whether a step asks the index for all triangles in the region, and not by something faster
  /// that the index offers for the rule.
  bool makes_queries() const noexcept { return makes_queries_; }

  /// How it behaves: radius, tool radius and margin, among others.
  const StepOptions& options() const noexcept { return options_; }

  /// The largest step that there is room for.
  const Capacity& capacity() const noexcept { return capacity_; }

  /// Behaves so from the next step on. Where the last step led is remembered. Throws Error, and
  /// changes nothing, for options that the constructor would refuse, or for more nodes than there
  /// is room for.
  void set_options(const StepOptions& options);

 private:
  Step step(const Motion& motion, SideWatch& sides, StageTimes* times) noexcept;
  void step_as_checked(const Motion& motion, SideWatch& sides, StageTimes* times,
                       Step& result) noexcept;
  void prepare();
  void reserve_solver(std::size_t guides);
  void require_usable(const StepOptions& options);

  std::unique_ptr<Budget> budget_;      // of a cycle
  std::unique_ptr<Neighborhood> near_;  // the rule holds on to it, wherever this is moved
  std::unique_ptr<ActivationRule> activation_;
  std::unique_ptr<Solver> solver_;
  StepOptions options_;
  Capacity capacity_;
  std::unique_ptr<Workspace> work_;
  FreePolytope polytope_;
  HalfSpaceBuffer polytope_planes_;
  bool makes_queries_;
  bool is_prepared_ = false;
  Inside inside_;
  bool watch_;  // whether sides are asked about
  SideWatch sides_;
};

}  // namespace keepout
