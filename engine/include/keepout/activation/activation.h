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

/// Planes, with a declared capacity.
using HalfSpaceBuffer = Buffer<HalfSpace>;

/// Where the solved motions of a cycle may end.
enum class Reach : std::uint8_t {
  thales,  // in the ball whose diameter runs from the tip to the aim: projections of the aim
  sphere   // anywhere in the motion sphere: with joints, or rows of the caller's own
};

/// What a rule decides from: the tip, where it shall go, and how far.
struct Surroundings {
  Vec3 tip;           // [length]
  Vec3 aim;           // increment that is wanted: the one asked for, or the way out [length]
  Vec3 kept;          // a motion that planes shall go on allowing; zero at first [length]
  double radius;      // of the motion sphere [length]
  double longest;     // no motion is longer: the radius, or less [length]
  double margin;      // distance to keep from the mesh [length], >= 0
  double recovery;    // how far to lead a tip away in a cycle that is too close [length]
  double rounding;    // what the tip may be off by after earlier steps [length]
  Reach reach;        // where motions may end
  Reach searched;     // what the region is to cover: as much, or more
  bool is_projected;  // the answer is the projection of the aim on the planes, by a solver on which
                      // idle planes have no bearing: a rule need not hand them over
};

/// Where motions may end, as a ball around a part of the tip's way.
Ball ends_of_motions(const Surroundings& around) noexcept;

/// How a cycle begins.
struct Opening {
  /// free: go for the aim. recovering: the tip is nearer than the margin, and `aim` leads away.
  /// Anything else ends the step.
  Status status = Status::free;
  Vec3 aim = Vec3::Zero();  // to go for instead, when recovering [length]
  /// From the tip to the nearest triangle, where the rule comes by it at no cost. [length]
  std::optional<double> distance = std::nullopt;
};

/// What a rule says of a trial motion.
struct Judgement {
  /// What is to become of the trial.
  enum class Verdict : std::uint8_t {
    accepted,
    objected,  // a plane that excludes the trial was added
    blocked    // the trial is not accepted, and no plane would help
  };
  Verdict verdict = Verdict::accepted;  // on the trial as a whole
  double free_share = 1.0;  // how much of the trial nothing speaks against, unless accepted
};

/// Decides which planes constrain a motion.
///
/// An eager rule hands over all of its planes in `start`. A lazy one is a separation oracle, as in
/// a cutting-plane method: `judge` is asked about each trial motion, and answers with a plane that
/// the trial violates until it has no objection left. One loop in `step` serves both. Nothing that
/// a rule holds over from one cycle to the next changes an answer.
class Activation {
 public:
  virtual ~Activation() = default;

  /// Says where to ask for triangles, and of which mesh, before all else; and again once that has
  /// become another one. The neighbourhood must outlive the rule. Allocates; everything after it
  /// does not.
  virtual void prepare(Neighborhood& near) { near_ = &near; }

  /// Whether it keeps off more than the tip: a tool of which the tip is but a point. What can be
  /// said of the tip alone, as its side or free space around it, does not hold for that.
  virtual bool guards_a_tool() const noexcept { return false; }

  /// How far its motions can lead when they are projections of the aim: with neither joints nor
  /// rows of the caller's own.
  virtual Reach reach() const noexcept { return Reach::sphere; }

  /// Where triangles matter: where motions end, and as much farther as planes are set back by the
  /// margin, unless the rule says otherwise. Precondition: prepare.
  virtual Ball region(const Surroundings& around) const noexcept;

  /// Asks the index about the region. False if it holds more than there is room for, or than the
  /// budget allows to look at.
  [[nodiscard]] virtual bool look_around(const Surroundings& around) noexcept;

  /// Appends the planes that hold whatever the trial. Precondition: look_around.
  virtual Opening start(const Surroundings& around, HalfSpaceBuffer& planes) noexcept = 0;

  /// Whether the motion may be made: by default if the planes allow it, which no solver is taken
  /// at its word for. A lazy rule appends the plane that speaks against it, if there is one.
  virtual Judgement judge(const Surroundings& around, const Vec3& trial,
                          HalfSpaceBuffer& planes) noexcept;

  /// The planes contradict each other: sets back those that may be. Whether any was.
  virtual bool relax(HalfSpaceBuffer& /*planes*/) noexcept { return false; }

  /// Fills `turned` with planes that allow around.kept, an accepted motion, as well as `planes`
  /// did, and may allow a better one. Whether they differ.
  virtual bool turn(const Surroundings& /*around*/, std::span<const HalfSpace> /*planes*/,
                    HalfSpaceBuffer& /*turned*/) noexcept {
    return false;
  }

  /// Planes that each have one triangle in reach behind them and allow standing still: other ways
  /// around it than the one that `judge` answered with.
  virtual void ways_around(TriangleId /*source*/, HalfSpaceBuffer& /*ways*/) const noexcept {}

  /// How many triangles its last answers rest on: all hits, or those that it asked about.
  virtual std::size_t triangles() const noexcept { return hits().size(); }

 protected:
  /// What is kept from. Precondition: prepare.
  const Mesh& mesh() const noexcept { return near_->mesh(); }
  /// For what the rule does itself. Precondition: prepare.
  Budget& budget() const noexcept { return near_->budget(); }
  /// What the last look_around found; empty before it.
  std::span<const Hit> hits() const noexcept {
    return near_ != nullptr ? near_->hits() : std::span<const Hit>();
  }
  /// Where it looked. Precondition: look_around.
  const Ball& looked_at() const noexcept { return near_->ball(); }

 private:
  Neighborhood* near_ = nullptr;
};

}  // namespace keepout
