// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "body_watch.h"
#include "certificate.h"
#include "guide_watch.h"

namespace keepout {

/// The rows on bodies and guides of one cycle: those that it begins with, and those that are added
/// as trial motions fail. They lie in the cycles' memory.
class WorkingRows {
 public:
  /// None yet. All must outlive it.
  WorkingRows(CycleMemory& memory, BodyWatch& watch, GuideWatch& guides,
              const InstrumentOptions& options) noexcept
      : memory_(memory), watch_(watch), guides_(guides), make_(memory, watch, options) {}

  /// Begins with the rows that held the last cycle back, and in recovery with those of what is too
  /// close.
  void start() noexcept;
  /// Adds rows for what spoke against the last motion (PairMemory::failure), or corrects those
  /// there are. Whether anything was changed.
  bool answer() noexcept;
  /// The same for a guide that was not kept beyond a cell.
  bool answer(std::size_t guide, int cell) noexcept;

  /// Takes the rows of a pair or a guide away (ContactRow::owner).
  void remove(std::size_t owner) noexcept;
  /// Notes which rows hold a solution back, by their numbers; numbers beyond the rows are not ours.
  /// Returns how many do.
  std::size_t hold(std::span<const std::uint32_t> active) noexcept;
  /// Puts rows, and which of them hold, aside; and takes them back.
  void put_aside() noexcept;
  /// The same.
  void take_back() noexcept;
  /// Turns the rows that hold to where the last motion ends. Whether any changed.
  bool turn() noexcept;
  /// For a motion that is shorter, and so bends less: what curvature took is so much of what it
  /// was.
  void forgive_curvature(double share) noexcept;
  /// Where nothing was found the next cycle begins with all that was learned.
  void remember_all() noexcept;

 private:
  void start_recovery(std::size_t pair) noexcept;
  void add(std::size_t pair, const NearTriangle& triangle, int cell) noexcept;
  bool correct(std::size_t owner, TriangleId triangle) noexcept;
  std::optional<ContactRow> row_of(const WarmRow& warm, int cell) noexcept;
  bool holds(const ContactRow& row) const noexcept;

  CycleMemory& memory_;
  BodyWatch& watch_;
  GuideWatch& guides_;
  ContactRows make_;
};

}  // namespace keepout
