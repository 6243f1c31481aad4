// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "keepout/geometry/pose.h"
#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"
#include "keepout/robot/instrument.h"
#include "keepout/status.h"
#include "keepout/step/guide.h"
#include "keepout/step/options.h"
#include "keepout/step/solver.h"

namespace keepout {

/// How a frame moves: what is asked of the flange in one cycle; or of a mesh, in a second. In the
/// axes of the world, which are those of the first mesh unless that is placed elsewhere.
struct Twist {
  Vec3 linear = Vec3::Zero();   // of its origin [length]
  Vec3 angular = Vec3::Zero();  // its turn: axis times angle [rad]
};

/// On which motion the certificate is taken.
enum class CertifiedMotion : std::uint8_t {
  actual,     // the one that the joints make
  linearised  // of points on straight lines, p + s J dq: what others do. Unsafe; for comparison
              // only
};

/// What stays the same from cycle to cycle.
struct InstrumentOptions {
  /// Distance to keep beyond each body's radius, from all meshes that have no margin of their own,
  /// > band [length]
  double margin = 0.2;
  /// What is held back of the margin, so that curved motions along a surface are proven: certified
  /// is margin - band. A wide band costs progress, never safety. See recommended_band. [length]
  double band = 0.002;
  double period = 1e-3;    // of a cycle: what velocity limits are multiplied by [s], > 0
  double recovery = 0.05;  // how far a body that is too close is led away in a cycle, >= 0 [length]
  /// Bodies come on slower where they are nearer to the margin than that, so that they touch it
  /// softly: a way of d left to it, they use up no more than d period / slowing_time in a cycle.
  /// What comes on is the instrument: a mesh that does is not fled. 0: nowhere. [length]
  double slowing_within = 0.0;
  double slowing_time = 0.05;  // how long the approach takes to come to an end, > 0 [s]
  /// Weight of |dq|^2 beside the task of the flange, >= 0: what singular poses give way to. A
  /// prismatic joint counts as a radian when it moves by orientation_weight, or by a length of 1
  /// where that is 0. [length^2]
  double damping = 0.1;
  /// What a turn of the flange counts beside its way, in lengths, >= 0: a radian off is as bad as
  /// so much. 0: only its origin is steered. [length / rad]
  double orientation_weight = 20.0;
  int refinements = 1;  // how often planes are turned towards a better motion, >= 0
  /// Whether bodies that no step has led to where they are have to be on the free side of a
  /// watertight mesh: by its winding, as tips are (docs/conventions.md).
  bool check_sides = true;
  CertifiedMotion certified = CertifiedMotion::actual;  // nothing else is safe
};

/// Room for the largest cycle.
struct InstrumentCapacity {
  std::size_t triangles = std::size_t{1} << 14;  // of one mesh, near one body
  std::size_t planes = 128;                      // posed at the same time
  /// The work of a cycle, whatever happens in it: see Budget. What cannot be proven with it is not
  /// moved. 0: Capacity::looks_of_a_walk on an index that walks by itself, as wide_bvh, and
  /// Capacity::looks_of_queries on others, of which more is asked.
  std::size_t looks = 0;
};

/// A body that keeps less than its certified distance from a mesh in a cycle.
struct DegradedClearance {
  int body = -1;             // its number
  int mesh = -1;             // and that of the mesh
  double level = 0.0;        // the fraction of the certified distance that it keeps, below 1
  bool is_certified = true;  // false: nothing is certified for it, and level is 0
};

/// What one cycle may do. Views stay valid until the next step.
struct InstrumentStep {
  Status status = Status::invalid_input;   // how it ended
  std::span<const double> increment = {};  // dq (n); empty unless ok() [rad or length]
  double share = 0.0;    // that is made of the motion that was found; below 1: it was cut short
  int rounds = 0;        // how often a trial motion was judged
  std::size_t rows = 0;  // that hold the motion back, joint limits apart
  std::size_t triangles = 0;  // in reach of one body and one trial motion, at the most
  /// From the body nearest to a mesh, as the cycle began; of bodies no farther off than that mesh's
  /// margin and the band, or slowing_within, and that there was work left to look at. Negative when
  /// the body reaches through the surface. [length]
  std::optional<double> distance = std::nullopt;
  int nearest = -1;       // the number of that body
  int nearest_mesh = -1;  // and of the mesh
  /// The least level of all pairs of body and mesh, 1 if all keep what is certified for them
  /// (InstrumentConstraint: F): below 1 if a mesh approaches faster than a body can retreat; 0 if a
  /// body could not be certified at all, or a mesh moves and there is no motion.
  double level = 1.0;
  /// The pairs of body and mesh that keep less; every other pair keeps what is certified for it.
  std::span<const DegradedClearance> degraded = {};
  std::span<const GuideState> guides = {};   // of each guide, in the order in which they were given
  Relaxation relaxation = Relaxation::none;  // what was relaxed
  /// The causes that kept the motion from being the commanded one. With a motion: all constraints
  /// that limit or shorten it. Without: the constraints for which no motion could be proved.
  /// joints_outside is reported with any status.
  Limits limits = {};

  /// Whether there is a motion that may be carried out; it may be zero.
  bool ok() const noexcept { return is_ok(status); }
  /// One line on what happened and what to do about it; a literal.
  std::string_view reason() const noexcept { return keepout::reason(status, Subject::instrument); }
};

/// How much of a motion is certified.
struct MotionProof {
  /// free: all of it; limited: a part of it; recovering: some body is too close at its start, and
  /// certified is that none comes closer by more than the band. Else why nothing more is known.
  Status status = Status::invalid_input;
  double share = 0.0;  // q + s dq is proven for s from 0 to here, whatever the status: 1 if all is
  std::optional<double> distance = std::nullopt;  // as InstrumentStep::distance [length]

  /// Returns one line on what happened and what to do about it.
  std::string_view reason() const noexcept { return keepout::reason(status, Subject::instrument); }
  /// Whether the instrument keeps the whole margin, less its band, on the whole motion.
  bool is_clear() const noexcept { return status == Status::free && share == 1.0; }
};

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
  static constexpr std::size_t most_meshes = 8;  // to be kept out of

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
  /// beyond most_meshes and as the constructor does. Allocates, and is not for the control path.
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

/// A band that absorbs the curvature of every motion that the joints' limits admit in a cycle of
/// `period` > 0 seconds: an eighth of the largest bend of any body's point, at least `least`.
/// Infinite without limits. [length]
double recommended_band(const Instrument& instrument, double period, double least = 0.002);

}  // namespace keepout
