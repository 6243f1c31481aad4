// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "keepout/index/budget.h"
#include "keepout/robot/instrument.h"
#include "keepout/robot/instrument_options.h"
#include "keepout/robot/motion_bounds.h"

namespace keepout {

/// Positions or increments of the joints. [rad or length]
using JointVector = std::array<double, Chain::most_joints>;

/// The positions of the points of a body's core. [length]
using CorePositions = std::array<Vec3, Instrument::most_points_of_a_body>;

/// The motion of an instrument's points while the joints move by an increment. It has their
/// positions at the knots of a grid (fractions 0, 1/64, ..., 1), and bounds of the motion between
/// knots. Positions are computed when they are first needed.
class PointMotion {
 public:
  /// The knot at the end of the motion; a knot k is at the fraction k / last_knot.
  static constexpr int last_knot = 64;

  /// The positions of all points at a knot.
  struct Positions {
    std::array<Vec3, Instrument::most_points> points;
    std::uint64_t motion_number = 0;  // the number of their motion; 0: not computed yet
  };

  /// Both arguments must outlive this object.
  PointMotion(const Instrument& instrument, Budget& budget);

  /// Begins a cycle, with the joints at q (n). Until set_trial() the increment is that of the last
  /// cycle, and positions are known at the start only.
  void begin_cycle(std::span<const double> q) noexcept;

  /// Sets the motion of the cycle, which begins at q: dq. `which`: the true motion, or the
  /// linearized one.
  void set_trial(const JointVector& increment, CertifiedMotion which) noexcept;

  /// Returns the motion: dq.
  const JointVector& increment() const noexcept { return increment_; }

  /// Returns the positions of all points at a knot, by their number. [length]
  const Vec3* points_at(int knot) noexcept {
    Positions& there = positions_[static_cast<std::size_t>(knot)];
    if (knot != 0 && there.motion_number != number_) compute(knot, there);
    return there.points.data();
  }
  /// Returns the positions of all points at the start of the cycle. [length]
  const Vec3* points_at_start() const noexcept { return positions_[0].points.data(); }
  /// Returns the chain at the start of the cycle.
  const ChainState& chain_at_start() const noexcept { return start_; }
  /// Returns the chain at a knot. Valid until the next call of chain_at, flange_at or points_at.
  const ChainState& chain_at(int knot) noexcept;
  /// Returns the pose of the flange at a fraction of the motion, in [0, 1].
  Pose flange_at(double fraction) noexcept;

  /// Returns the bounds of a point's motion.
  const MotionBounds& bounds(std::size_t point) const noexcept { return bounds_[point]; }
  /// Returns the number of the motion, which no other motion has.
  std::uint64_t number() const noexcept { return number_; }

 private:
  const ChainState& chain_at_fraction(double fraction) noexcept;
  void compute(int knot, Positions& there) noexcept;
  void fill(const ChainState& state, Positions& positions) const noexcept;

  const Instrument* instrument_;
  Budget* budget_;
  JointVector q_{};
  JointVector increment_{};
  CertifiedMotion which_ = CertifiedMotion::actual;
  ChainState start_;
  ChainState state_;
  std::array<MotionBounds, Instrument::most_points> bounds_{};
  std::array<Vec3, Instrument::most_points> straight_;  // J dq, of the linearized motion
  std::vector<Positions> positions_;                    // (last_knot + 1)
  std::uint64_t number_ = 0;
  std::uint64_t number_of_state_ = 0;  // the motion that state_ is of; 0: none
  double fraction_of_state_ = 0.0;     // of that motion
};

}  // namespace keepout
