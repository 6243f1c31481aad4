// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "cycle_memory.h"

namespace keepout {

/// How the guides stand as a cycle begins, how far out each may come in it, and the proof that a
/// motion goes no farther: a region's excess is convex and no steeper than 1, so on a part of the
/// motion it is no more than at one of the ends, and an eighth of the bend.
class GuideWatch {
 public:
  /// The motion's start must be where the joints are. Both must outlive it.
  GuideWatch(CycleMemory& memory, const InstrumentOptions& options) noexcept
      : memory_(memory), options_(options) {}

  /// Looks at all guides.
  void open() noexcept;
  /// Whether some guide is out by more than its band.
  bool is_recovering() const noexcept { return is_recovering_; }
  /// Whether that guide is.
  bool is_recovering(std::size_t guide) const noexcept;

  /// Returns the excess that a relaxed guide may end with, if a fraction of its band is kept
  /// unused. [length or rad]
  double allowance(std::size_t guide, double unused) const noexcept;

  /// Returns true if rounding has put a guide farther out than it may be, so that the end of a
  /// motion must be farther in than its start.
  bool owes() const noexcept { return owes_; }

  /// Returns true if the second-derivative bound of a motion allows its guide to end farther out
  /// than it started, by more than its band, although the row pulls the guide back.
  bool bends_by_more(const ContactRow& row, std::span<const double> increment) const noexcept;

  /// Takes a guide out of what is proved in this cycle: it contradicts the clearance from a mesh
  /// that moves.
  void drop(std::size_t guide) noexcept { is_dropped_[guide] = true; }
  /// Returns true if it was.
  bool is_dropped(std::size_t guide) const noexcept { return is_dropped_[guide]; }

  /// Up to which cell all guides are proven to be kept on the motion at hand; and, if not to the
  /// last, which one was not.
  int judge(std::size_t& failed) noexcept;

  /// A row that keeps a guide behind the plane that touches its region where it is at a share of
  /// the motion. Nothing in the region's middle, which has no such plane.
  std::optional<ContactRow> row(std::size_t guide, int cell) noexcept;
  /// Where the row's guide is, relative to its plane's level, at the end of the motion.
  double height_at_end(const ContactRow& row) noexcept;

 private:
  /// How a guide stands at a share of the motion.
  struct Standing {
    double excess;
    double share;  // see guided_fraction
  };

  Standing standing(std::size_t guide, int cell) noexcept;
  int proven_until(std::size_t guide, int lo, const Standing& at_lo, int hi,
                   const Standing& at_hi) noexcept;
  const ChainState& chain_at(int cell) noexcept;

  CycleMemory& memory_;
  const InstrumentOptions& options_;
  ChainState chain_;
  int cell_of_chain_ = 0;  // where that is, on the motion at hand; 0: not known
  bool is_recovering_ = false;
  bool owes_ = false;
  std::array<double, Guide::most> allowed_{};  // excess of each in this cycle
  std::array<double, Guide::most> at_end_{};   // excess that each may have at the end of a motion
  std::array<bool, Guide::most> is_dropped_{};
};

}  // namespace keepout
