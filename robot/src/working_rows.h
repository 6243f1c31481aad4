// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "guide_watch.h"
#include "row_maker.h"

namespace keepout {

/// The working set of one cycle: the rows on bodies and guides that it starts with, and those that
/// it adds when trial motions fail.
class WorkingRows {
 public:
  /// Starts empty. All arguments must outlive this object.
  WorkingRows(CycleMemory& memory, PairWatch& pairs, GuideWatch& guides,
              const CycleConstants& cycle) noexcept
      : memory_(memory), pairs_(pairs), guides_(guides), maker_(memory, pairs, cycle) {
    memory_.rows.clear();
  }

  /// Returns the rows.
  std::span<const Row> view() const noexcept { return memory_.rows.view(); }
  /// Returns true if not all rows fit.
  bool overflowed() const noexcept { return memory_.rows.overflowed(); }

  /// Adds the rows that the last cycle remembered, and for bodies and guides that recover, rows
  /// that pull them back.
  void add_first_rows() noexcept;
  /// Adds rows for the obstacles to the last motion, one obstacle of each pair. If a triangle has
  /// all of its rows, corrects them instead, unless rows of an earlier pair have changed: later
  /// motions correct them then. Returns true if any row changed.
  bool add(std::span<const Certificate::Obstacle> obstacles) noexcept;
  /// Like add(obstacles), but for a guide that the motion violates beyond a knot.
  bool add(const GuideWatch::Obstacle& obstacle) noexcept;

  /// Removes the rows of a pair or a guide.
  void remove(std::size_t owner) noexcept;
  /// Remembers the active rows of a solution, by their numbers, for the next cycle; ignores numbers
  /// beyond the rows, which are limits of joints. A triangle with two active rows counts twice. The
  /// next cycle then starts with two equal rows of it, and add() continues with rows of the
  /// vertices.
  void remember(std::span<const std::uint32_t> active) noexcept;
  /// Remembers all rows for the next cycle, after a cycle that found no motion.
  void remember_all() noexcept;
  /// Rotates the planes of the remembered rows to those at the end of the trial motion
  /// (re-linearization). All rows of a remembered triangle become the row of its contact there, and
  /// all rows of a guide become one. Gradients stay those at the start of the cycle. Returns true
  /// if any plane changed.
  bool turn_planes_to_end() noexcept;
  /// Restores the rows that turn_planes_to_end() has replaced.
  void turn_back() noexcept;
  /// Scales the corrections for curvature by a factor, for a motion that may be shorter, and allows
  /// three more corrections.
  void scale_corrections(double factor) noexcept;

 private:
  void add_recovery_rows(std::size_t pair) noexcept;
  bool add(std::size_t pair, const NearTriangle& triangle, int knot) noexcept;
  bool correct(std::size_t owner, TriangleId triangle) noexcept;
  std::optional<Row> row_of(const WarmRow& warm, int knot) noexcept;
  bool is_remembered(const Row& row) const noexcept;

  CycleMemory& memory_;
  PairWatch& pairs_;
  GuideWatch& guides_;
  RowMaker maker_;
};

}  // namespace keepout
