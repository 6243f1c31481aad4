// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "keepout/buffer.h"
#include "keepout/geometry/ball.h"
#include "keepout/geometry/half_space.h"
#include "keepout/index/refine.h"
#include "keepout/index/spatial_index.h"

namespace keepout {

/// Planes, with a declared capacity.
using HalfSpaceBuffer = Buffer<HalfSpace>;

/// Where the solved motions of a cycle may end.
enum class Reach : std::uint8_t {
  thales,  // in the ball whose diameter runs from the tip to the aim: projections of the aim
  sphere   // anywhere in the motion sphere: with joints, or rows of the caller's own
};

/// Which of its planes a rule is to hand over.
enum class NeededPlanes : std::uint8_t {
  all,
  in_the_way  // those idle may be left out that no projection of the aim can violate
};

/// What a rule decides from: the tip, where it shall go, and every triangle in reach of the motion.
struct Surroundings {
  Vec3 tip;             // [length]
  Vec3 aim;             // increment that is wanted: the one asked for, or the way out [length]
  Vec3 kept;            // a motion that planes shall go on allowing; zero at first [length]
  double radius;        // of the motion sphere [length]
  double longest;       // no motion is longer: the radius, or less [length]
  double margin;        // distance to keep from the mesh [length], >= 0
  double recovery;      // how far to lead a tip away in a cycle that is too close [length]
  double rounding;      // what the tip may be off by after earlier steps [length]
  Reach reach;          // where motions may end
  Reach searched;       // what the region is to cover: as much, or more
  NeededPlanes needed;  // which planes the rule is to hand over
  Ball ball;            // what the rule asked for: see Activation::region
  std::span<const Hit> hits;  // in that ball, sorted by id; relative to the ball's centre
};

/// How a cycle begins.
struct Opening {
  /// How the tip stands to the surface.
  enum class Stance : std::uint8_t {
    clear,         // the tip keeps its distance: go for the aim
    too_close,     // nearer than the margin: `aim` leads away from the surface
    touching,      // on the surface: no telling which side is free
    no_margin,     // the margin is too small for the numbers at hand to tell
    over_capacity  // more triangles than room was made for
  };
  Stance stance = Stance::clear;  // what the cycle is to do
  Vec3 aim = Vec3::Zero();        // to go for instead, when too close [length]
  /// From the tip to the nearest triangle, if every form of the rule comes by it at no cost.
  /// [length]
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

/// What a rule keeps off the surface.
enum class Guarded : std::uint8_t {
  tip,  // the tip, and the ball around it that the margin makes
  tool  // a body of its own, of which the tip is but a point
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

  /// Makes room. Allocates; everything after it does not.
  virtual void reserve(std::size_t /*triangles*/) {}

  /// The same rule in a form that searches this index by itself, and faster: its answers are the
  /// same bit for bit. Null if there is none. The index must outlive it, and stay as it is.
  virtual std::unique_ptr<Activation> searching(const SpatialIndex& /*index*/) const {
    return nullptr;
  }

  /// Whether it is such a form: the surroundings it is asked about need no hits.
  virtual bool searches() const noexcept { return false; }

  /// How many triangles its last answers rest on: all hits, or those that it found by itself.
  virtual std::size_t triangles(const Surroundings& around) const noexcept {
    return around.hits.size();
  }

  /// What else can be said of the tip alone, such as its side or free space around it, holds for
  /// what is guarded only if that is the tip.
  virtual Guarded guarded() const noexcept { return Guarded::tip; }

  /// How far its motions can lead when they are projections of the aim: with neither joints nor
  /// rows of the caller's own.
  virtual Reach reach() const noexcept { return Reach::sphere; }

  /// Where triangles matter: the motion sphere, and as much farther as planes are set back by the
  /// margin, unless the rule says otherwise. `around` has no hits yet.
  virtual Ball region(const Surroundings& around) const noexcept;

  /// Appends the planes that hold whatever the trial.
  virtual Opening start(const Surroundings& around, HalfSpaceBuffer& planes) noexcept = 0;

  /// Whether the motion may be made: by default if the planes allow it, which no solver is taken
  /// at its word for. A lazy rule appends the plane that speaks against it, if there is one.
  virtual Judgement judge(const Surroundings& around, const Vec3& trial,
                          HalfSpaceBuffer& planes) noexcept;

  /// The planes contradict each other: sets back those that may be. Whether any was.
  virtual bool relax(HalfSpaceBuffer& /*planes*/) const noexcept { return false; }

  /// Fills `turned` with planes that allow around.kept, an accepted motion, as well as `planes`
  /// did, and may allow a better one. Whether they differ.
  virtual bool turn(const Surroundings& /*around*/, std::span<const HalfSpace> /*planes*/,
                    HalfSpaceBuffer& /*turned*/) noexcept {
    return false;
  }

  /// Planes that each have one triangle in reach behind them and allow standing still: other ways
  /// around it than the one that `judge` answered with.
  virtual void ways_around(const Surroundings& /*around*/, TriangleId /*source*/,
                           HalfSpaceBuffer& /*ways*/) const noexcept {}
};

/// What `step` needs of a rule; a final class that satisfies it is called without dispatch.
template <class T>
concept ActivationRule = requires(T& rule, const Surroundings& around, const Vec3& trial,
                                  HalfSpaceBuffer& planes) {
  { rule.searches() }
  noexcept->std::same_as<bool>;
  { rule.triangles(around) }
  noexcept->std::same_as<std::size_t>;
  { rule.reach() }
  noexcept->std::same_as<Reach>;
  { rule.region(around) }
  noexcept->std::same_as<Ball>;
  { rule.start(around, planes) }
  noexcept->std::same_as<Opening>;
  { rule.judge(around, trial, planes) }
  noexcept->std::same_as<Judgement>;
  { rule.relax(planes) }
  noexcept->std::same_as<bool>;
  { rule.ways_around(around, TriangleId{}, planes) }
  noexcept;
  { rule.turn(around, planes.view(), planes) }
  noexcept->std::same_as<bool>;
};

}  // namespace keepout
