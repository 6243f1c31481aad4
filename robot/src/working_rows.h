// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "body_watch.h"
#include "guide_watch.h"
#include "keepout/buffer.h"

namespace keepout {

/// The identity of a row of the last problem that a cycle solved: the next cycle starts with it.
struct WarmRow {
  std::size_t owner;  // see Row
  TriangleId triangle;
};

/// The rows of a cycle, and those that the next one starts with. Made once for all cycles.
struct RowMemory {
  /// Makes memory for so many rows. Allocates.
  explicit RowMemory(std::size_t capacity)
      : rows(capacity), earlier_rows(capacity), warm(capacity), earlier_warm(capacity) {}

  Buffer<Row> rows;
  Buffer<Row> earlier_rows;  // while better ones are tried
  Buffer<WarmRow> warm;
  Buffer<WarmRow> earlier_warm;
};

/// The working set of one cycle: the rows on bodies and guides that it starts with, and those that
/// are added as trial motions fail.
class WorkingRows {
 public:
  /// Starts empty. All must outlive it.
  WorkingRows(RowMemory& memory, BodyWatch& bodies, GuideWatch& guides,
              const CycleContext& context) noexcept
      : memory_(memory),
        bodies_(bodies),
        guides_(guides),
        context_(context),
        maker_(bodies, context) {}

  /// Returns the rows.
  std::span<const Row> view() const noexcept { return memory_.rows.view(); }
  /// Returns true if not all rows fit.
  bool overflowed() const noexcept { return memory_.rows.overflowed(); }
  /// Removes all rows.
  void clear() noexcept { memory_.rows.clear(); }

  /// Starts with the rows that limited the last cycle, and for bodies and guides that recover, with
  /// rows that pull them back.
  void start() noexcept;
  /// Adds rows for the obstacles to the last motion, one of each pair, or corrects the rows of
  /// their triangles. Returns true if any row changed.
  bool add(std::span<const Certificate::Obstacle> obstacles) noexcept;
  /// Like add(obstacles), but for a guide that the motion violates beyond a knot.
  bool add(const GuideWatch::Obstacle& obstacle) noexcept;

  /// Removes the rows of a pair or a guide.
  void remove(std::size_t owner) noexcept;
  /// Remembers the rows that limit a solution, by their numbers, for the next cycle; ignores
  /// numbers beyond the rows. Returns the number of rows that limit it.
  std::size_t remember(std::span<const std::uint32_t> active) noexcept;
  /// Remembers all rows for the next cycle, after a cycle that found no motion.
  void remember_all() noexcept;
  /// Saves the rows and what is remembered.
  void save() noexcept;
  /// Restores what was saved.
  void restore() noexcept;
  /// Replaces the planes of the remembered rows by those at the end of the last motion. Gradients
  /// stay those at the start of the cycle. Returns true if any plane turned.
  bool relinearize() noexcept;
  /// Scales the corrections for curvature, for a shorter motion, and allows three more.
  void forgive_curvature(double fraction) noexcept;

 private:
  void start_recovery(std::size_t pair) noexcept;
  void add(std::size_t pair, const NearTriangle& triangle, int knot) noexcept;
  bool correct(std::size_t owner, TriangleId triangle) noexcept;
  std::optional<Row> row_of(const WarmRow& warm, int knot) noexcept;
  bool is_remembered(const Row& row) const noexcept;

  RowMemory& memory_;
  BodyWatch& bodies_;
  GuideWatch& guides_;
  const CycleContext& context_;
  RowMaker maker_;
};

}  // namespace keepout
