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
#include "keepout/robot/instrument_monitor.h"
#include "keepout/robot/instrument_options.h"
#include "keepout/robot/instrument_step.h"
#include "keepout/step/solver.h"

namespace keepout {

/// Keeps a whole instrument out of meshes, in joint space. A step returns the joint increment
/// nearest to the commanded one that is proved to keep each body clear. The proof covers the motion
/// that the joints really make.
///
/// Only the certificate is trusted. Planes, solver and linearization propose a motion. The true
/// motion q + s dq, s in [0, 1], is then proved, or truncated to the part that is proved.
///
/// Guarantee (docs/joint-space-step.md, Theorem 1, with its conditions and assumptions): a joint
/// that starts within its limits stays within them. Each pair of a body and a mesh has a certified
/// clearance F from the body's surface: margin - band, or less if the body starts closer. Let the
/// core of the body (see Body) be at least radius + F from the mesh at the start. Then it is at
/// least radius + F - 3 tolerance from the mesh for all s.
///
/// If a mesh moves in the cycle (see place), the guarantee is for its pose at each s (Theorem 3).
/// The joints must then execute the whole increment, at constant speed over the cycle. If they
/// execute only a part of it, nothing is proved. A pair in InstrumentStep::degraded maintains only
/// DegradedClearance::fraction times F, or no clearance if is_certified is false. All other pairs
/// maintain F.
///
/// Not thread-safe: make one for each control loop. Mesh and index may be shared.
class InstrumentConstraint {
 public:
  /// Combines the parts, and allocates all memory. The index must be built on `mesh`. Throws Error
  /// if a part is missing, if the index is for another mesh, or if an option or a capacity is out
  /// of range.
  InstrumentConstraint(std::shared_ptr<const Mesh> mesh, std::shared_ptr<const SpatialIndex> index,
                       Instrument instrument, std::unique_ptr<Solver> solver,
                       const InstrumentOptions& options, const InstrumentCapacity& capacity = {});
  /// Like the constructor above, but without a mesh. Until a mesh is added, only limits of joints
  /// and guides apply.
  InstrumentConstraint(Instrument instrument, std::unique_ptr<Solver> solver,
                       const InstrumentOptions& options, const InstrumentCapacity& capacity = {});
  /// Moves. The source may only be destroyed or assigned to.
  InstrumentConstraint(InstrumentConstraint&&) noexcept;
  /// Like the move constructor.
  InstrumentConstraint& operator=(InstrumentConstraint&&) noexcept;
  ~InstrumentConstraint();

  /// Runs one control cycle: returns the increment whose motion of the flange is nearest to
  /// `displacement`. `displacement`: a motion for one cycle, not a velocity [length], [rad]. `q`:
  /// the positions (n) of the joints [rad or length]. Revolute joints must be within 100 rad of 0,
  /// prismatic ones within 100 times the size of instrument and meshes. On failure the increment is
  /// empty and the status gives the cause; meshes with a velocity still move by one period. Does
  /// not allocate or throw.
  InstrumentStep step(std::span<const double> q, const Twist& displacement) noexcept;

  /// Like step(q, const Twist&), but returns the increment dq nearest to `desired` (n): minimizes
  /// sum w_k (dq_k - desired_k)^2. `weights`: w (n), above 0; empty: all 1.
  InstrumentStep step(std::span<const double> q, std::span<const double> desired,
                      std::span<const double> weights = {}) noexcept;

  /// Adds a mesh from the next step on, and returns its number; the first has 0. `margin`: for this
  /// mesh, above the band; 0: the margin of the options [length]. Forgets the last cycle, like
  /// forget(). All meshes share the work budget of a cycle, which is by default that of the slowest
  /// index: see InstrumentCapacity::work_units. Throws Error, and changes nothing, for more meshes
  /// than InstrumentCapacity::most_meshes, and for a margin that is negative or NaN. Also does so
  /// for a mesh or an index that the constructor would reject. Allocates: not for the control path.
  std::size_t add_mesh(std::shared_ptr<const Mesh> mesh, std::shared_ptr<const SpatialIndex> index,
                       double margin = 0.0);

  /// Sets the pose of a mesh at the start of the next cycle, and its velocity. The velocity is that
  /// of its frame's origin [length/s], and of its rotation about that origin [rad/s]. The index is
  /// not rebuilt. A mesh with a velocity moves in every step until it is placed again, so a loop
  /// should place it in each cycle, at its measured pose. The proof assumes that the mesh moves at
  /// this velocity. The margin must cover the difference to its true motion within a cycle.
  ///
  /// The rotation must be orthonormal to 1e-6 in each element of R^T R; the nearest exact rotation
  /// replaces it. The position must be within 100 times the lengths of instrument and meshes. Each
  /// component of the velocity must be below 1e9. Returns free if the pose is accepted. Otherwise
  /// returns invalid_input: the mesh keeps its last pose and velocity, and step() returns
  /// invalid_input until a valid pose is set. For a number that no mesh has, returns invalid_input
  /// and changes nothing.
  ///
  /// step() returns invalid_input while a mesh turns by more than a radian in a cycle, or moves by
  /// more than 100 times the lengths of instrument and meshes. It returns margin_too_small while a
  /// mesh is so far away that rounding hides the margin or a band. prove() ignores the velocities
  /// of meshes. Does not allocate or throw.
  Status place(std::size_t number, const Pose& pose, const Twist& velocity = {}) noexcept;

  /// Returns the pose of a mesh at the start of the next cycle. Precondition: there is such a mesh.
  const Pose& place_of(std::size_t number) const noexcept;

  /// Returns the part of a motion that is clear, without a search for a better motion: for
  /// planners. An increment of 0 tests a configuration. `increment`: dq (n), of any size. Long
  /// motions are proved in up to 64 parts, each with the work budget of a cycle. The proof ends at
  /// a part that starts too close. Ignores joint limits, and the side of the mesh on which the last
  /// step was. Use a separate constraint for planning: the next step after prove() starts without
  /// the rows of the last step, and classifies all bodies as inside or outside again.
  MotionProof prove(std::span<const double> q, std::span<const double> increment) noexcept;

  /// Forgets the last cycle. Call this if the next motion does not start where the last one ended.
  void forget() noexcept;

  /// Replaces the guides from the next step on: see Guide. If a guided point is outside its region
  /// at that time, it may move out by at most one more band. Throws Error, and changes nothing, for
  /// more guides than Guide::most, for link 0 or a link that the chain does not have, or if
  /// rounding hides a band. Allocates: not for the control path.
  void set_guides(std::vector<Guide> guides);

  /// Sets a monitor, which must confirm each motion from the next step on, or removes it (nullptr).
  /// A step whose motion it does not confirm is `unconfirmed`. add_mesh() and follow() pass it each
  /// new mesh; the meshes so far must be its own already. Guides and joint limits are not
  /// monitored.
  void set_monitor(std::unique_ptr<InstrumentMonitor> monitor);

  /// Follows anatomy that has deformed: continues with a mesh and its index. The index may be the
  /// present one after a refit, or one built elsewhere meanwhile. All bodies are classified again.
  /// A body that is now too close recovers. A body inside a watertight mesh is reported
  /// (Status::inside). After a refit, step() returns mesh_changed until this is called. `number`:
  /// of the mesh, whose pose stays. Throws Error, and changes nothing, if the index is for another
  /// mesh, if no mesh has the number, or if rounding hides the margin for a mesh of this size.
  /// Allocates: not for the control path.
  void follow(std::shared_ptr<const Mesh> moved, std::shared_ptr<const SpatialIndex> index,
              std::size_t number = 0);

  /// Returns the instrument.
  const Instrument& instrument() const noexcept;
  /// Returns the number of meshes.
  std::size_t mesh_count() const noexcept;
  /// Returns a mesh. Precondition: there is such a mesh.
  const Mesh& mesh(std::size_t number = 0) const noexcept;
  /// Returns the options.
  const InstrumentOptions& options() const noexcept;
  /// Sets the options from the next step on. Bodies that are too close for a larger margin recover.
  /// Throws Error, and changes nothing, for options that the constructor would refuse.
  void set_options(const InstrumentOptions& options);

  /// Returns the tolerance, within which distances count as equal: about 1e-12 of the size of
  /// instrument and meshes. [length]
  double tolerance() const noexcept;
  /// Returns the work units that the last step spent: see Budget.
  std::size_t work_units() const noexcept;
  /// Returns work_units().
  [[deprecated("use work_units()")]] std::size_t looks() const noexcept { return work_units(); }

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace keepout
