// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "cycle_context.h"
#include "near_set.h"
#include "relative_motion.h"

namespace keepout {

class BodyWatch;

/// The largest number of pairs of a body and a mesh.
constexpr std::size_t most_pairs = Instrument::most_bodies * InstrumentCapacity::most_meshes;

/// A point of a body's core: a fraction of the segment between two of its points. For a blade,
/// which is on one link, a position on that link.
struct CorePoint {
  double fraction = 0.0;        // from the first point to the second
  Vec3 on_link = Vec3::Zero();  // of a blade: in the link's frame [length]
};

/// A linear constraint on the joints' increment, gradient . dq >= bound, that limits a point of a
/// body by a plane with one triangle behind it. A row only proposes; the certificate decides.
struct ContactRow {
  /// The number of the pair of a body and a mesh; from most_pairs on, of a guide, whose plane
  /// touches its region and no triangle.
  std::size_t owner;
  TriangleId triangle;  // no_triangle for a guide
  /// The point of the body; nothing for one of its end points, number `end` of the instrument's.
  std::optional<CorePoint> point = std::nullopt;
  std::uint8_t end = 0;
  Vec3 normal = Vec3::Zero();  // of the plane, in the mesh's frame: unit, towards the body
  double offset = 0.0;         // the point p must satisfy n . p >= offset [length]
  JointVector gradient = {};   // n . J
  double bound = 0.0;          // before any correction; above 0 it demands a retreat [length]
  double start_height = 0.0;   // n . p - offset at the start of the cycle [length]
  double drift = 0.0;          // of the height in the cycle, by the mesh's own motion [length]
  double correction = 0.0;     // for the curvature of earlier trials [length]
  int corrections = 0;
};

/// Makes rows for the bodies of an instrument at the start of a cycle.
class ContactRows {
 public:
  /// Both must outlive it.
  ContactRows(const BodyWatch& watch, const CycleContext& context) noexcept
      : watch_(watch), context_(context) {}

  /// Returns a row for the body's point that is nearest to a triangle at a cell of the motion. It
  /// limits that point alone, so that the body may roll and pivot over the triangle. Its normal is
  /// the one at the cell, turned back as far as the point's position at the start requires. Returns
  /// nothing if body and triangle touch.
  std::optional<ContactRow> at_contact(std::size_t pair, const NearTriangle& triangle,
                                       int cell) noexcept;

  /// Returns a row for an end point of the body, whose plane is valid for all end points. Returns
  /// nothing if body and triangle touch.
  std::optional<ContactRow> at_end_point(std::size_t pair, std::uint8_t end,
                                         const NearTriangle& triangle, int cell) noexcept;

  /// Returns the height of the row's point over its plane at the end of the motion. [length]
  double height_at_end(const ContactRow& row) noexcept;

 private:
  Gap gap_at(std::size_t pair, const Triangle& corners, int cell) noexcept;
  CorePoint core_point(std::size_t pair, const Vec3& contact, int cell) noexcept;
  Vec3 position_of(std::size_t pair, const CorePoint& point, int cell) noexcept;
  void finish(ContactRow& row, const Vec3& at, const Triangle& corners) const noexcept;

  const BodyWatch& watch_;
  const CycleContext& context_;
};

}  // namespace keepout
