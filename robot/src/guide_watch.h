// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "cycle_memory.h"

namespace keepout {

/// The excess that a cycle allows each guide, and the proof that a motion does not exceed it: a
/// region's excess is convex and no steeper than 1, so on a sub-interval of the motion it is at
/// most the larger one of its ends, and an eighth of the second-derivative bound.
class GuideWatch {
 public:
  /// How far all guides allow a motion.
  struct Obstacle {
    int knot = PointMotion::last_knot;  // proved up to here
    std::size_t guide = 0;              // which is violated beyond, if that is not the end
  };

  /// The trial motion must have begun the cycle. Both must outlive it.
  GuideWatch(CycleMemory& memory, const CycleConstants& cycle) noexcept
      : memory_(memory), cycle_(cycle) {}

  /// Measures all guides.
  void open() noexcept;
  /// Returns the number of guides.
  std::size_t size() const noexcept { return memory_.guides.size(); }
  /// Returns the state of each guide.
  std::span<GuideState> states() noexcept { return memory_.guide_states; }
  /// Returns true if some guide is outside its region by more than its band.
  bool is_recovering() const noexcept { return is_recovering_; }
  /// Returns true if that guide is.
  bool is_recovering(std::size_t guide) const noexcept;

  /// Returns the excess that a relaxed guide may end with, if a fraction of its band must remain
  /// unused. [length or rad]
  double allowance(std::size_t guide, double unused) const noexcept;

  /// Returns true if rounding has put a guide farther out than it may be, so that the end of a
  /// motion must be farther in than its start.
  bool owes() const noexcept { return owes_; }

  /// Returns true if a motion may bend so much that its guide ends farther out than it started, by
  /// more than its band, although the row pulls the guide back.
  bool may_leave_again(const Row& row, std::span<const double> increment) const noexcept;

  /// Takes a guide out of what is proved in this cycle: it contradicts the clearance from a mesh
  /// that moves.
  void drop(std::size_t guide) noexcept { is_dropped_[guide] = true; }
  /// Returns true if the guide was dropped.
  bool is_dropped(std::size_t guide) const noexcept { return is_dropped_[guide]; }

  /// Proves the trial motion for all guides, as far as possible.
  Obstacle judge() noexcept;

  /// Returns a row that limits a guide by the plane that touches its region at the guided point at
  /// a knot of the motion; nothing at the region's center, which has no such plane.
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
  std::array<double, Guide::most> allowed_{};  // excess of each in this cycle
  std::array<double, Guide::most> at_end_{};   // excess that each may have at the end of a motion
  std::array<bool, Guide::most> is_dropped_{};
};

}  // namespace keepout
