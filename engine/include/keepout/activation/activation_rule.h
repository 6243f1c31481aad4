// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "keepout/buffer.h"
#include "keepout/geometry/shapes.h"
#include "keepout/index/query.h"
#include "keepout/status.h"

namespace keepout {

/// A list of planes with a fixed capacity.
using HalfSpaceBuffer = Buffer<HalfSpace>;

/// The region of the tip's increments in which the solved motions of a cycle may end.
enum class EndRegion : std::uint8_t {
  target_ball,  // the ball whose diameter is the target: contains its projections (Thales)
  /// The ball around the tip of radius RuleInput::longest, for motions that need not be
  /// projections. Used with joints, rows, a retreat, guides that pull points back, other rules, or
  /// Query::sphere.
  motion_sphere
};

/// The input of a rule in a cycle.
struct RuleInput {
  Vec3 tip;          // [length]
  Vec3 target;       // the desired increment, a part of it, or the retreat [length]
  Vec3 accepted;     // accepted motion, which planes must still allow; else zero [length]
  double radius;     // of the motion sphere [length]
  double longest;    // bound of all motions: longest_motion() or twice the retreat [length]
  double clearance;  // required clearance: tool radius + margin [length], >= 0
  double recovery;   // the longest retreat of a tip that is too close, in a cycle [length]
  double rounding;   // bound of the error of the tip's position [length]
  EndRegion searched_region;  // contains the ends of all motions that a solver may find
  /// True if the rule may leave out idle planes (Solver::ignores_idle_planes): the solver ignores
  /// them, and there are no joints, rows, damping or guides that pull points back.
  bool is_projected = false;
};

/// Returns the smallest ball that contains searched_region, in the frame of the mesh.
Ball searched_ends(const RuleInput& input) noexcept;

/// The start of a cycle.
struct Opening {
  /// free: solve for the target. recovering: the tip is closer than the required clearance, and
  /// `target` is its retreat. Any other status ends the step.
  Status status = Status::free;
  Vec3 target = Vec3::Zero();  // the retreat, when recovering [length]
  /// The distance from the tip to the nearest triangle, if the rule knows it at no cost. [length]
  std::optional<double> distance = std::nullopt;
};

/// The judgement of a rule on a trial motion.
struct Judgement {
  /// The outcome.
  enum class Verdict : std::uint8_t {
    accepted,
    objected,  // planes were added, of which at least one excludes the trial
    blocked    // the trial is not accepted, and no plane can help
  };
  Verdict verdict = Verdict::accepted;  // on the trial as a whole
  double free_fraction = 1.0;           // the part of a rejected trial that is free
};

/// Chooses the planes (HalfSpace) that limit a motion.
///
/// An eager rule adds all of its planes in `open`. A lazy rule is a separation oracle, as in a
/// cutting-plane method. Its `judge` receives each trial motion, and either accepts the trial or
/// adds a plane that the trial violates. The same loop runs both kinds (Cycle::solve_and_judge).
/// State that a rule stores between cycles never changes a result, unless the work budget ends.
class ActivationRule {
 public:
  virtual ~ActivationRule() = default;

  /// Sets the neighborhood in which the rule gathers triangles. Must be called before any other
  /// function, and again when the mesh has changed. The neighborhood must outlive the rule.
  /// Allocates; all other functions do not.
  virtual void prepare(Neighborhood& neighborhood) { neighborhood_ = &neighborhood; }

  /// Returns true if the rule guards a whole tool, not only the tip. The side of the tip, and the
  /// free space around the tip, then say nothing about the tool.
  virtual bool guards_a_tool() const noexcept { return false; }

  /// Returns true if the rule queries the index for all triangles in the region; false if it uses
  /// the index's own traversal (SpatialIndex::traverse_along_motions). Precondition: prepare.
  virtual bool makes_queries() const noexcept { return true; }

  /// Returns the region that must contain the ends of motions if there are neither joints nor rows.
  /// All motions are then projections of the target.
  virtual EndRegion end_region() const noexcept { return EndRegion::motion_sphere; }

  /// Returns a ball that touches all triangles that matter. By default it is the ball of
  /// searched_ends(), grown by the required clearance. Precondition: prepare.
  virtual Ball region(const RuleInput& input) const noexcept;

  /// Gathers the triangles that touch region() from the index, or begins a traversal that finds
  /// them trial by trial. Returns false if they exceed the capacity or the work budget.
  [[nodiscard]] virtual bool gather(const RuleInput& input) noexcept;

  /// Opens a cycle: determines if the tip is too close, and appends the planes that hold for every
  /// trial. May already judge the target, which is the first trial. Precondition: gather.
  virtual Opening open(const RuleInput& input, HalfSpaceBuffer& planes) noexcept = 0;

  /// Judges a trial motion. By default, accepts a trial that satisfies the planes, because the
  /// solver is not trusted to ensure this. A lazy rule appends a plane that the trial violates, if
  /// there is one. Precondition: the trial ends in the searched region, as triangles beyond were
  /// not searched.
  virtual Judgement judge(const RuleInput& input, const Vec3& trial,
                          HalfSpaceBuffer& planes) noexcept;

  /// Relaxes planes that pull the tip back, if the planes contradict each other. Returns true if
  /// any plane changed.
  virtual bool relax(HalfSpaceBuffer& /*planes*/) noexcept { return false; }

  /// Linearizes `planes` again at input.accepted, a motion that the rule has accepted, and fills
  /// `next` with them. They allow this motion too, and may allow a better one. Returns true if any
  /// plane changed.
  virtual bool relinearize(const RuleInput& /*input*/, std::span<const HalfSpace> /*planes*/,
                           HalfSpaceBuffer& /*next*/) noexcept {
    return false;
  }

  /// Adds alternatives to the plane that `judge` has added for a triangle. Each alternative has
  /// this triangle behind it, and allows zero motion.
  virtual void add_alternatives(TriangleId /*triangle*/,
                                HalfSpaceBuffer& /*planes*/) const noexcept {}

  /// Returns the number of triangles that the last result depends on. These are hits, or examined
  /// triangles. A triangle that the rule forgot and examined again counts twice.
  virtual std::size_t triangles() const noexcept { return hits().size(); }

 protected:
  /// Returns the mesh. Precondition: prepare.
  const Mesh& mesh() const noexcept { return neighborhood_->mesh(); }
  /// Returns the index. Precondition: prepare.
  const SpatialIndex& index() const noexcept { return neighborhood_->index(); }
  /// Returns the work budget. Precondition: prepare.
  Budget& budget() const noexcept { return neighborhood_->budget(); }
  /// Returns the hits of the last gather; empty before it.
  std::span<const Hit> hits() const noexcept {
    return neighborhood_ != nullptr ? neighborhood_->hits() : std::span<const Hit>();
  }
  /// Returns the ball of the last gather. Precondition: gather.
  const Ball& gathered_ball() const noexcept { return neighborhood_->ball(); }

 private:
  Neighborhood* neighborhood_ = nullptr;
};

}  // namespace keepout
