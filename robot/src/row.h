// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "keepout/robot/instrument_options.h"
#include "point_motion.h"

namespace keepout {

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

/// A linear constraint on the joints' increment. It limits a point of a body by a plane with one
/// triangle behind it, or a guide by a plane that touches its region. It demands
///
///     gradient . dq >= bound + correction - drift,
///
/// for a body minus PairWatch::degradation. JointProblem relaxes bound and correction if need be. A
/// row only proposes; the certificate decides.
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

}  // namespace keepout
