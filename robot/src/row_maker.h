// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "pair_watch.h"
#include "row.h"

namespace keepout {

/// Makes the rows of bodies, with gradients at the start of the cycle. A knot is one of the trial
/// motion.
class RowMaker {
 public:
  /// All arguments must outlive this object.
  RowMaker(CycleMemory& memory, const PairWatch& pairs, const CycleConstants& cycle) noexcept
      : memory_(memory), pairs_(pairs), cycle_(cycle) {}

  /// Returns a row for the body's point that is nearest to a triangle at a knot of the motion. The
  /// row limits that point alone, so that the body may roll and pivot over the triangle. Its normal
  /// is that of the gap at the knot, rotated towards the one at the start until the plane allows
  /// the start. Returns no row if body and triangle touch.
  std::optional<Row> at_contact(std::size_t pair, const NearTriangle& triangle, int knot) noexcept;

  /// Adds a row for each point of the body's core that a joint moves, all with one plane. Adds no
  /// row if body and triangle touch at the start. Precondition: the triangle is measured.
  void at_vertices(std::size_t pair, const NearTriangle& triangle, int knot,
                   Buffer<Row>& rows) noexcept;

  /// Returns the height of the row's point over its plane at the end of the motion. [length]
  double height_at_end(const Row& row) noexcept;

 private:
  Gap gap_at(std::size_t pair, const NearTriangle& triangle, int knot) noexcept;
  CorePoint core_point(std::size_t pair, const Vec3& contact, int knot) noexcept;
  Vec3 position_of(std::size_t pair, const CorePoint& point, int knot) noexcept;
  void finish(Row& row, const Vec3& at, const Triangle& corners) const noexcept;

  CycleMemory& memory_;
  const PairWatch& pairs_;
  const CycleConstants& cycle_;
};

}  // namespace keepout
