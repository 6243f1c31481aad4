// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "cycle_memory.h"

namespace keepout {

/// The excess that a cycle allows each guide, and the proof that a motion does not exceed it. The
/// excess of a region is convex, and its slope is at most 1. So on a sub-interval of length t it is
/// at most the larger excess of both ends, plus t^2/8 times the second-derivative bound.
class GuideWatch {
 public:
  /// The part of a motion that all guides allow.
  struct Obstacle {
    int knot = PointMotion::last_knot;  // proved up to here
    std::size_t guide = 0;              // the guide that the motion violates beyond an earlier knot
  };

  /// Precondition: the trial motion has begun the cycle. Both arguments must outlive this object.
  GuideWatch(CycleMemory& memory, const CycleConstants& cycle) noexcept
      : memory_(memory), cycle_(cycle) {}

  /// Measures all guides.
  void open() noexcept;
  /// Returns the number of guides.
  std::size_t size() const noexcept { return memory_.guides.size(); }
  /// Returns the state of each guide.
  std::span<GuideState> states() noexcept { return memory_.guide_states; }
  /// Returns true if any guide is outside its region by more than its band.
  bool is_recovering() const noexcept { return is_recovering_; }
  /// Returns true if the guide is outside its region by more than its band.
  bool is_recovering(std::size_t guide) const noexcept;

  /// Returns the excess that a relaxed guide may have at the end of a motion, if the fraction
  /// `unused` of its band must remain. [length or rad]
  double allowance(std::size_t guide, double unused) const noexcept;

  /// Returns true if a guide has a deficit: it is farther out than certified, so a motion must end
  /// farther in than it starts.
  bool owes() const noexcept { return owes_; }

  /// Returns true if the curvature of a motion may put its guide farther out than at the start, by
  /// more than its band, although the row pulls the guide back.
  bool may_leave_again(const Row& row, std::span<const double> increment) const noexcept;

  /// Drops a guide from the proofs of this cycle, because it contradicts the clearance from a
  /// moving mesh.
  void drop(std::size_t guide) noexcept { is_dropped_[guide] = true; }
  /// Returns true if the guide was dropped.
  bool is_dropped(std::size_t guide) const noexcept { return is_dropped_[guide]; }

  /// Proves as much of the trial motion as possible, for all guides. Returns the first obstacle.
  Obstacle judge() noexcept;

  /// Returns a row that limits a guide by a plane that touches its region: where the region is
  /// nearest to the guided point at a knot of the motion. Returns no row if that point is the
  /// region's center, for which there is no such plane.
  std::optional<Row> row(std::size_t guide, int knot) noexcept;
  /// Returns the height of the row's guided point over its plane at the end of the motion.
  double height_at_end(const Row& row) noexcept;

 private:
  /// A guide at one point of the motion.
  struct Sample {
    double excess;
    double fraction;  // see guided_fraction
  };

  Sample sample(std::size_t guide, int knot) noexcept;
  int proved_until(std::size_t guide, int lo, const Sample& at_lo, int hi,
                   const Sample& at_hi) noexcept;

  CycleMemory& memory_;
  const CycleConstants& cycle_;
  bool is_recovering_ = false;
  bool owes_ = false;
  std::array<double, Guide::most> allowed_{};  // the excess of each guide in this cycle
  std::array<double, Guide::most> at_end_{};   // the same at the end of a motion
  std::array<bool, Guide::most> is_dropped_{};
};

}  // namespace keepout
