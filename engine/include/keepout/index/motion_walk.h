// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "keepout/geometry/shapes.h"
#include "keepout/ids.h"

namespace keepout {

class Neighborhood;

/// A triangle that a walk along a motion shows.
struct Encounter {
  /// A note before the visitor writes one.
  static constexpr std::uint32_t no_note = ~std::uint32_t{0};

  TriangleId triangle;  // its number
  /// A number of the visitor's own for the triangle, which it may write here. The walk may forget
  /// it before it begins again: then it shows the triangle as a new one.
  std::uint32_t& note;
  /// The corners relative to the tip, in lexicographic order of the mesh's coordinates; null if
  /// there is a note, as the visitor then knows them. [length]
  const Triangle* corners;
};

/// Visits the triangles that a walk shows.
class EncounterVisitor {
 public:
  /// Returns the fraction of the motion after which triangles no longer matter; it never grows.
  virtual double visit(const Encounter& encounter) noexcept = 0;

 protected:
  ~EncounterVisitor() = default;
};

/// A source of triangles: finds those in the way of straight motions that start at one tip, motion
/// after motion. The visitor judges them by its own arithmetic, in whatever order they come: so
/// answers depend neither on the source nor on its memory. An index may offer a source that is
/// faster than a query for all triangles in the region (SpatialIndex::walk_along_motions).
class MotionWalk {
 public:
  /// What the motions to come have in common.
  struct Start {
    Vec3 tip;        // where they start [length]
    Ball region;     // touches every triangle that they may come within `level` of
    double level;    // a motion comes near a triangle within this distance [length]
    double longest;  // no motion is longer [length]
  };

  /// A fraction of a motion that stands for never.
  static constexpr double after_the_end = 2.0;

  virtual ~MotionWalk() = default;

  /// Begins a cycle of motions; no triangle has a note. Returns false if the region holds more
  /// triangles than there is room for, or than the budget allows: then nothing may be concluded
  /// until a walk begins well. (A walk with a search of its own may always return true.)
  [[nodiscard]] virtual bool begin(const Start& start) noexcept = 0;

  /// Begins again with the same motions, another level and no notes. Precondition: as for walk().
  virtual void begin_again(double level) noexcept = 0;

  /// Returns true if the region is known to hold no triangle.
  virtual bool is_free() const noexcept = 0;

  /// Shows the visitor each triangle that the motion may come within the level of, and perhaps
  /// others. It may leave out those that it surely meets later than the fraction that the visitor
  /// returned last, but it shows all that may be within the level at the start of the motion. Once
  /// the budget is spent it stops, and triangles may have been left out.
  ///
  /// Returns true if neither this motion, nor any other whose end is within `alike` times its
  /// length of its own, comes near a triangle. Precondition: begin() returned true, and is_free()
  /// is false.
  virtual bool walk(const Vec3& motion, EncounterVisitor& visitor) noexcept = 0;

  /// The distance of the ends of two motions that are equally free, as a fraction of their length.
  static constexpr double alike = 1e-7;

  /// Returns the number of triangles that may get notes between two beginnings.
  virtual std::size_t room() const noexcept = 0;
};

/// Returns the index's own walk, or, if it has none, one that shows all of its exact hits in the
/// region; within the neighborhood's budget. The neighborhood must outlive it.
std::unique_ptr<MotionWalk> make_motion_walk(Neighborhood& near);

}  // namespace keepout
