// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "near_set.h"
#include "relative_motion.h"

namespace keepout {

class BodyWatch;
struct CycleMemory;

/// A point of a body's core: a share of the way between two of its points, or for a blade, which is
/// on one link, a place on that.
struct CorePoint {
  double share = 0.0;           // from the first point to the second
  Vec3 on_link = Vec3::Zero();  // of a blade: in the link's frame [length]
};

/// A linear row on the joints' increment that keeps a point of a body on its side of a plane that
/// has one triangle behind it: gradient . dq >= bound. It proposes; the certificate decides.
struct ContactRow {
  /// The number of the pair of body and mesh; from most_pairs on, of a guide, whose plane touches
  /// its region and not a triangle.
  std::size_t owner;
  TriangleId triangle;  // no_triangle for a guide
  /// Which point of the body; nothing: one of its end points, number `end` of the instrument's.
  std::optional<CorePoint> point = std::nullopt;
  std::uint8_t end = 0;
  Vec3 normal = Vec3::Zero();  // of the plane, as its mesh has it: unit, towards the body
  double level = 0.0;  // n . p is to be no less than that, p the point as the cycle begins [length]
  JointVector gradient = {};  // n . J
  double bound = 0.0;         // before any correction; above 0 it leads away [length]
  double start_height = 0.0;  // of the point over the level, as the cycle begins [length]
  double drift = 0.0;         // by how much the mesh's own motion lifts it in the cycle [length]
  double correction = 0.0;    // what curvature took from the row in earlier trials [length]
  int corrections = 0;
};

/// Makes rows for the bodies of an instrument at the start of a cycle.
class ContactRows {
 public:
  /// Work is taken from the memory's budget. All must outlive it.
  ContactRows(CycleMemory& memory, const BodyWatch& watch,
              const InstrumentOptions& options) noexcept
      : memory_(memory), watch_(watch), options_(options) {}

  /// Where a triangle is met at a share of the motion: a row on that point of the body alone, so
  /// that the body may roll and pivot over the triangle. Its normal is the one there, turned back
  /// as far as the point's place at the start needs. Nothing where they touch.
  std::optional<ContactRow> witness(std::size_t pair, const NearTriangle& triangle,
                                    int cell) noexcept;

  /// The same plane for an end point of the body, valid for all of them. Nothing where they touch.
  std::optional<ContactRow> end_point(std::size_t pair, std::uint8_t end,
                                      const NearTriangle& triangle, int cell) noexcept;

  /// Where the row's point is, relative to its plane's level, at the end of the motion. [length]
  double height_at_end(const ContactRow& row) noexcept;

 private:
  Gap gap_at(std::size_t pair, const Triangle& corners, int cell) noexcept;
  CorePoint core_point(std::size_t pair, const Vec3& contact, int cell) noexcept;
  Vec3 place_of(std::size_t pair, const CorePoint& point, int cell) noexcept;
  void finish(ContactRow& row, const Vec3& at, const Triangle& corners) const noexcept;

  std::span<const std::uint8_t> points_of(std::size_t pair) const noexcept;
  RelativeMotion& motion(std::size_t pair) const noexcept;
  double radius(std::size_t pair) const noexcept;

  CycleMemory& memory_;
  const BodyWatch& watch_;
  const InstrumentOptions& options_;
};

}  // namespace keepout
