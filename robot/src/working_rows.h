// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "body_watch.h"
#include "guide_watch.h"
#include "keepout/buffer.h"

namespace keepout {

/// The identity of a row that limited a motion: the next cycle starts with it.
struct WarmRow {
  std::size_t owner;  // see ContactRow
  TriangleId triangle;
};

/// The rows of a cycle, and those that the next one starts with. Made once for all cycles.
struct RowMemory {
  /// Makes memory for so many rows. Allocates.
  explicit RowMemory(std::size_t capacity)
      : rows(capacity), earlier_rows(capacity), warm(capacity), earlier_warm(capacity) {}

  Buffer<ContactRow> rows;
  Buffer<ContactRow> earlier_rows;  // while better ones are tried
  Buffer<WarmRow> warm;
  Buffer<WarmRow> earlier_warm;
};

/// The working set of one cycle: the rows on bodies and guides that it starts with, and those that
/// are added as trial motions fail.
class WorkingRows {
 public:
  /// Starts empty. All must outlive it.
  WorkingRows(RowMemory& memory, BodyWatch& watch, GuideWatch& guides,
              const CycleContext& context) noexcept
      : memory_(memory), watch_(watch), guides_(guides), context_(context), make_(watch, context) {}

  /// Returns the rows.
  std::span<const ContactRow> view() const noexcept { return memory_.rows.view(); }
  /// Returns true if not all rows fit.
  bool overflowed() const noexcept { return memory_.rows.overflowed(); }
  /// Removes all rows.
  void clear() noexcept { memory_.rows.clear(); }

  /// Starts with the rows that limited the last cycle, and for bodies and guides that recover, with
  /// rows that pull them back.
  void start() noexcept;
  /// Adds rows for the triangles that the last motion failed at, one of each pair, or corrects the
  /// rows that these have. Returns true if any row changed.
  bool add(std::span<const Certificate::Failure> failures) noexcept;
  /// Like add(failures), but for a guide that the motion violates beyond a cell.
  bool add(std::size_t guide, int cell) noexcept;

  /// Removes the rows of a pair or a guide (ContactRow::owner).
  void remove(std::size_t owner) noexcept;
  /// Notes the rows that limit a solution, by their numbers, for the next cycle; numbers beyond the
  /// rows are ignored. Returns the number of rows that limit it.
  std::size_t note_active(std::span<const std::uint32_t> active) noexcept;
  /// Saves the rows and those that limit the solution.
  void save() noexcept;
  /// Restores the saved rows.
  void restore() noexcept;
  /// Linearizes the rows that limit the solution again, at the end of the last motion. Returns true
  /// if any row changed.
  bool relinearize() noexcept;
  /// Scales the corrections for curvature, for a motion that is shorter.
  void forgive_curvature(double fraction) noexcept;
  /// Has the next cycle start with all rows, after one that found no motion.
  void note_all() noexcept;

 private:
  void start_recovery(std::size_t pair) noexcept;
  void add(std::size_t pair, const NearTriangle& triangle, int cell) noexcept;
  bool correct(std::size_t owner, TriangleId triangle) noexcept;
  std::optional<ContactRow> row_of(const WarmRow& warm, int cell) noexcept;
  bool is_active(const ContactRow& row) const noexcept;

  RowMemory& memory_;
  BodyWatch& watch_;
  GuideWatch& guides_;
  const CycleContext& context_;
  ContactRows make_;
};

}  // namespace keepout
