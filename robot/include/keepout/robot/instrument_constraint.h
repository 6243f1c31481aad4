// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "keepout/geometry/pose.h"
#include "keepout/geometry/twist.h"
#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"
#include "keepout/robot/instrument.h"
#include "keepout/robot/instrument_options.h"
#include "keepout/robot/instrument_step.h"
#include "keepout/step/solver.h"

namespace keepout {

/// Keeps a whole instrument out of meshes, in joint space: the joint increment nearest to what is
/// asked for that provably keeps each body clear, on the motion that the joints really make.
///
/// Only the certificate is trusted. Planes, solver and linearisation propose a motion; the true
/// motion q + s dq, s in [0, 1], is then proven, or cut back to the part of it that is.
///
/// Guarantee: if dist(body(q), mesh) >= radius + F at the start, with F the certified distance,
/// margin - band (or what is left of it, when a body is closer already), then
/// dist(body(q + s dq), mesh) >= radius + F - 3 tolerance for all s in [0, 1] and all bodies; joint
/// limits hold all along. Proof: docs/joint-space-step.md.
///
/// If a mesh moves in the cycle as `place` says, the same holds wherever it is at s, for the whole
/// of an increment: a part of it is not safe then. A pair of body and mesh that
/// InstrumentStep::degraded names keeps level F in place of F, or nothing; all other pairs keep F.
///
/// Not thread-safe: one for each control loop; mesh and index may be shared.
class InstrumentConstraint {
 public:
  /// The index must be built on `mesh`. Throws Error when a part is missing, the index is of
  /// another mesh, or an option or a capacity is out of range. Makes all memory here.
  InstrumentConstraint(std::shared_ptr<const Mesh> mesh, std::shared_ptr<const SpatialIndex> index,
                       Instrument instrument, std::unique_ptr<Solver> solver,
                       const InstrumentOptions& options, const InstrumentCapacity& capacity = {});
  /// Takes over all that another one has, which is of no use any more.
  InstrumentConstraint(InstrumentConstraint&&) noexcept;
  /// The same.
  InstrumentConstraint& operator=(InstrumentConstraint&&) noexcept;
  ~InstrumentConstraint();

  /// Steers the flange. `q`: the joints' positions (n), of revolute ones within +-100 rad, of
  /// others within some hundred times the lengths at hand: else invalid_input. [rad or length]
  /// Allocates nothing, throws nothing. On any trouble the increment is empty and the status says
  /// why.
  InstrumentStep step(std::span<const double> q, const Twist& desired) noexcept;

  /// Steers the joints: the nearest to `desired`, dq (n), each joint's weighed by `weights` (n, >
  /// 0; all 1 when empty): min sum w_k (dq_k - desired_k)^2.
  InstrumentStep step(std::span<const double> q, std::span<const double> desired,
                      std::span<const double> weights = {}) noexcept;

  /// Keeps out of one more mesh from the next step on, and returns its number; the constructor's
  /// has 0. `margin`: of its own, > band; 0 for that of the options. [length] All begins anew, as
  /// after `forget`. The work of a cycle does not grow with it. Throws Error, and changes nothing,
  /// beyond most_meshes of the capacity and as the constructor does. Allocates: not for control.
  std::size_t add_mesh(std::shared_ptr<const Mesh> mesh, std::shared_ptr<const SpatialIndex> index,
                       double margin = 0.0);

  /// Sets the pose of a mesh as the next cycle begins, and its velocity: of its frame's origin
  /// [length/s], and its turn about that [rad/s]. Nothing is built anew. A mesh that moves is taken
  /// to go on so with every step, until it is placed again: so a loop places it in each cycle, as
  /// it is measured. The error of that prediction within a cycle belongs into the mesh's margin.
  ///
  /// The rotation must be one to 1e-6 in each element of R^T R; it is made exact. The position must
  /// be within 100 times the lengths of instrument and meshes, each component of the velocity below
  /// 1e9. Returns free if the pose is accepted. Otherwise returns invalid_input: the mesh keeps its
  /// last pose and velocity, and step() returns invalid_input until a valid pose is set. A number
  /// that no mesh has is invalid_input and changes nothing.
  ///
  /// step() returns invalid_input while a mesh turns by more than a radian in a cycle, or moves by
  /// more than 100 times the lengths of instrument and meshes, and
  /// margin_too_small while it is so far away that rounding hides the margin or a band. Proofs take
  /// meshes to stay where they are. Allocates nothing, throws nothing.
  Status place(std::size_t mesh, const Pose& pose, const Twist& velocity = {}) noexcept;

  /// Where a mesh is, as the next cycle begins. Precondition: there is one of that number.
  const Pose& place_of(std::size_t mesh) const noexcept;

  /// Looks at a motion, and does not solve for a better one: for planners, which ask of many, and
  /// of single configurations by an increment of 0. `increment`: dq (n), of any size; long ones are
  /// proven in up to 64 parts, each with the work of a cycle, up to the first that starts too
  /// close. Limits of joints are not looked at, and it does not matter where the last step led.
  /// Meant for a constraint of the planner's own: the next step forgets which rows held the last
  /// one back, and has its side checked.
  MotionProof prove(std::span<const double> q, std::span<const double> increment) noexcept;

  /// Forgets what the last cycle left: for motions that have nothing to do with each other.
  void forget() noexcept;

  /// Replaces the guides from the next step on: see Guide. A guided point outside its region may
  /// move farther out by one band again. Throws Error, and changes nothing, for more guides than
  /// Guide::most, a link that the chain does not have or that no joint moves (0), or a band that is
  /// lost in rounding. Allocates: not for the control path.
  void set_guides(std::vector<Guide> guides);

  /// Goes on with anatomy that has moved: with a mesh and an index of it, which may be the one at
  /// hand, refit, or one that was made ready elsewhere in the meantime. Bodies are placed anew; a
  /// body that the surface came too close to recovers, one that it came over is told of (inside),
  /// if the mesh is watertight. Once an index is refit, every step is `mesh_changed` until it is
  /// followed. `number`: of which mesh, which stays placed as it is. Allocates, and is not for the
  /// control path. Throws Error, and stays as it is, if the index is not of this mesh, there is
  /// none of that number, or the options are lost in the rounding of its size.
  void follow(std::shared_ptr<const Mesh> moved, std::shared_ptr<const SpatialIndex> index,
              std::size_t number = 0);

  /// What is kept out.
  const Instrument& instrument() const noexcept;
  /// How many meshes it is kept out of.
  std::size_t mesh_count() const noexcept;
  /// One of them. Precondition: there is one of that number.
  const Mesh& mesh(std::size_t number = 0) const noexcept;
  /// How it behaves.
  const InstrumentOptions& options() const noexcept;
  /// Behaves so from the next step on. Throws Error, and changes nothing, for options that the
  /// constructor would refuse. A raised margin is come up to by recovery.
  void set_options(const InstrumentOptions& options);

  /// Distances are told apart down to this: some 1e-12 of the lengths at hand. [length]
  double tolerance() const noexcept;
  /// How much work the last step was: see Budget.
  std::size_t looks() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace keepout
