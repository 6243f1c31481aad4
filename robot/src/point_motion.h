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

/// Positions of joints, or what is added to them.
using JointVector = std::array<double, Chain::most_joints>;

/// Where the points of a body's core are. [length]
using Core = std::array<Vec3, Instrument::most_points_of_a_body>;

/// The points of an instrument on their way while the joints move by an increment: where they are,
/// on a grid of shares of the motion, and what bounds them in between. Positions are computed when
/// they are first asked for.
class PointMotion {
 public:
  /// The grid's cells; shares are c / cells.
  static constexpr int cells = 64;

  /// Takes its work from the budget. Both must stay where they are.
  PointMotion(const Instrument& instrument, Budget& budget);

  /// A new cycle, with the joints at q (n).
  void start(std::span<const double> q) noexcept;

  /// Another motion from there: dq.
  void move(const JointVector& increment, CertifiedMotion which) noexcept;

  /// The motion: dq.
  const JointVector& increment() const noexcept { return increment_; }

  /// Where all points are at a share of the motion, by their number. [length]
  const Vec3* at(int cell) noexcept;
  /// Where they are as the cycle begins. [length]
  const Vec3* at_start() const noexcept { return places_[0].points.data(); }
  /// The chain as the cycle begins.
  const ChainState& chain_at_start() const noexcept { return start_; }
  /// Where the chain is at a share of the motion.
  void place(int cell, ChainState& state) const noexcept;
  /// Returns the pose of the flange at a share of the motion, in [0, 1].
  Pose flange_at(double share) noexcept;

  /// What bounds the way of a point.
  const MotionBounds& bounds(std::size_t point) const noexcept { return bounds_[point]; }
  /// Which motion it is, of all that there were.
  std::uint64_t number() const noexcept { return motion_; }

 private:
  struct Place {
    std::array<Vec3, Instrument::most_points> points;
    std::uint64_t motion = 0;  // of which motion; 0: none
  };

  void place_at(double share, ChainState& state) const noexcept;
  void fill(const ChainState& state, Place& place) const noexcept;

  const Instrument* instrument_;
  Budget* budget_;
  JointVector q_{};
  JointVector increment_{};
  CertifiedMotion which_ = CertifiedMotion::actual;
  ChainState start_;
  ChainState state_;
  std::array<MotionBounds, Instrument::most_points> bounds_{};
  std::array<Vec3, Instrument::most_points> straight_;  // J dq, of the linearised motion
  std::vector<Place> places_;                           // (cells + 1)
  std::uint64_t motion_ = 0;
  std::uint64_t placed_motion_ = 0;  // of state_: the motion and the share of it; 0: none
  double placed_share_ = 0.0;
};

}  // namespace keepout
