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

/// The owner of a row: the number of a pair of a body and a mesh, or above these, of a guide.
constexpr std::size_t owner_of_guide(std::size_t guide) noexcept { return most_pairs + guide; }
/// Returns true if the owner is a guide.
constexpr bool is_guide(std::size_t owner) noexcept { return owner >= most_pairs; }
/// Returns the number of the guide. Precondition: is_guide(owner).
constexpr std::size_t guide_of(std::size_t owner) noexcept { return owner - most_pairs; }

/// A point of a body's core: a fraction of the segment between two of its points. For a blade,
/// which is on one link, a position on that link.
struct CorePoint {
  double fraction = 0.0;        // from the first point to the second
  Vec3 on_link = Vec3::Zero();  // of a blade: in the link's frame [length]
};

/// A linear constraint on the joints' increment that limits a point of a body by a plane with one
/// triangle behind it, or a guide by a plane that touches its region:
/// gradient . dq >= bound + correction - drift. A row only proposes; the certificate decides.
struct Row {
  std::size_t owner;    // a pair or a guide: see owner_of_guide
  TriangleId triangle;  // no_triangle for a guide
  /// The limited point of the body; empty if it is point number `vertex` of the instrument.
  std::optional<CorePoint> point = std::nullopt;
  std::uint8_t vertex = 0;
  Vec3 normal = Vec3::Zero();  // of the plane, in the mesh's frame: unit, towards the body
  double offset = 0.0;         // the point p must satisfy n . p >= offset [length]
  JointVector gradient = {};   // n . J
  double bound = 0.0;          // above 0 the row pulls back: it demands a retreat [length]
  double start_height = 0.0;   // n . p - offset at the start of the cycle [length]
  double drift = 0.0;          // of the height in the cycle, by the mesh's own motion [length]
  double correction = 0.0;     // for the curvature of earlier trials [length]
  int corrections = 0;
};

/// Makes the rows of bodies, with gradients at the start of the cycle.
class RowMaker {
 public:
  /// Both must outlive it.
  RowMaker(const BodyWatch& bodies, const CycleContext& context) noexcept
      : bodies_(bodies), context_(context) {}

  /// Returns a row for the body's point that is nearest to a triangle at a knot of the motion. The
  /// row limits that point alone, so that the body may roll and pivot over the triangle. Its normal
  /// is that of the gap at the knot, turned back as far as the point's position at the start
  /// requires. Returns no row if body and triangle touch.
  std::optional<Row> at_contact(std::size_t pair, const NearTriangle& triangle, int knot) noexcept;

  /// Returns a row for one point of the body's core, whose plane is valid for all of them. Returns
  /// no row if body and triangle touch.
  std::optional<Row> at_vertex(std::size_t pair, std::uint8_t vertex, const NearTriangle& triangle,
                               int knot) noexcept;

  /// Returns the height of the row's point over its plane at the end of the motion. [length]
  double height_at_end(const Row& row) noexcept;

 private:
  Gap gap_at(std::size_t pair, const Triangle& corners, int knot) noexcept;
  CorePoint core_point(std::size_t pair, const Vec3& contact, int knot) noexcept;
  Vec3 position_of(std::size_t pair, const CorePoint& point, int knot) noexcept;
  void finish(Row& row, const Vec3& at, const Triangle& corners) const noexcept;

  const BodyWatch& bodies_;
  const CycleContext& context_;
};

}  // namespace keepout
