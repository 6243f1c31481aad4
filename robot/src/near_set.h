// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gap.h"
#include "keepout/index/query.h"
#include "near_blocks.h"

namespace keepout {

/// A triangle that may matter in a cycle, and how a body stands to it.
struct NearTriangle {
  TriangleId id;
  double least;             // its distance from the core, as the cycle begins, is no less [length]
  const Triangle* corners;  // valid until triangles are looked for again
  Vec3* normal;  // the last one that parted it from the core, which may do so again: see `know`
  bool is_known = false;  // whether the gap is
  Gap at_start = {};      // as the cycle begins
};

/// The triangles around one body, kept from cycle to cycle: while no point of the body has moved
/// farther than they were looked for, nothing else can be in reach. What is told of them is decided
/// by the engine and not by the index, so it is the same on each.
class NearSet {
 public:
  /// With room for so many triangles, for a body whose core is all within `beyond` of the segment
  /// of its first two points. Allocates; nothing else does. [length]
  NearSet(std::size_t room, double beyond);

  /// Looks for all triangles within `radius` of a core, in the places of its points. False if there
  /// are too many, or the budget is spent: then nothing is known. [length]
  [[nodiscard]] bool gather(Neighborhood& near, std::span<const Vec3> core, double radius,
                            Budget& budget) noexcept;

  /// Forgets all: nothing is known.
  void forget() noexcept { radius_ = -1.0; }

  /// How far around the core all is known, from where it was then. Below 0: nothing is. [length]
  double radius() const noexcept { return radius_; }
  /// Where the points of the core were then. [length]
  std::span<const Vec3> core() const noexcept { return core_; }
  /// How many triangles there are.
  std::size_t size() const noexcept { return ids_.size(); }
  /// Returns true if no more triangles fit.
  bool is_full() const noexcept { return ids_.size() == room_; }

  /// A new cycle, with the core elsewhere.
  void start_cycle(std::span<const Vec3> core) noexcept;
  /// Those that may be nearer than that to the core as the cycle begins, the nearest first; of
  /// equals the first by number. Valid until triangles are looked for again, or the next cycle.
  /// Work is taken from the budget. [length]
  std::span<NearTriangle> nearer_than(double distance, Budget& budget) noexcept;
  /// Finds the gap of one of them as the cycle begins, unless it is known.
  void know(NearTriangle& triangle, Budget& budget) noexcept;

 private:
  NearScreen screen(double distance) const noexcept;

  std::size_t room_;
  double beyond_;
  double radius_ = -1.0;
  std::vector<Vec3> core_;
  double size_ = 0.0;  // the largest coordinate, from the core's first point [length]
  std::vector<TriangleId> ids_;
  std::vector<Triangle> corners_;
  std::vector<NearBlock> blocks_;  // the same in floats
  std::vector<Vec3> normals_;  // that parted them from the core when their gap was found; or zero
  // Of this cycle.
  std::vector<Vec3> now_;     // the core's points
  Vec3 from_ = Vec3::Zero();  // the segment of the first two
  Vec3 to_ = Vec3::Zero();
  std::vector<NearTriangle> told_;
  std::vector<std::uint64_t> told_in_;  // the cycle in which each was
  std::uint64_t cycle_ = 0;
  double told_below_ = 0.0;  // all that may be nearer than that are among them
};

}  // namespace keepout
