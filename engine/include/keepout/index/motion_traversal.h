// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "keepout/geometry/shapes.h"
#include "keepout/ids.h"

namespace keepout {

class Neighborhood;

/// Visits the triangles that a traversal shows.
class TriangleVisitor {
 public:
  /// Visits a triangle. `note`: a number of the visitor's own for the triangle, which it may write;
  /// MotionTraversal::no_note if it has written none, or if the traversal had to forget it, which
  /// then shows the triangle as a new one. `corners`: relative to the tip, in lexicographic order
  /// of the mesh's coordinates; null if there is a note, as the visitor then knows them. [length]
  /// Returns the fraction of the motion after which triangles no longer matter; it never grows.
  virtual double visit(TriangleId triangle, std::uint32_t& note,
                       const Triangle* corners) noexcept = 0;

 protected:
  ~TriangleVisitor() = default;
};

/// Finds the triangles in the way of straight motions that start at one tip, motion after motion
/// (the traversal of docs/certified-step.md). The visitor judges them by its own arithmetic, in
/// whatever order they come: so answers depend neither on the traversal nor on its memory, unless
/// the work budget ends. An index may offer a traversal that is faster than a query for all
/// triangles in the region (SpatialIndex::traverse_along_motions).
class MotionTraversal {
 public:
  /// What the motions to come have in common.
  struct Start {
    Vec3 tip;        // where they start [length]
    Ball region;     // touches every triangle that they may come within `level` of
    double level;    // a motion comes near a triangle within this distance [length]
    double longest;  // no motion is longer [length]
  };

  /// The note of a triangle before the visitor writes one.
  static constexpr std::uint32_t no_note = ~std::uint32_t{0};
  /// A fraction of a motion after its end.
  static constexpr double never = 2.0;

  virtual ~MotionTraversal() = default;

  /// Begins a cycle, whose motions all start at one tip; no triangle has a note. Returns false if
  /// the region holds more triangles than there is room for, or than the budget allows: then
  /// nothing may be concluded until a traversal begins well. (A traversal with a search of its own
  /// may always return true.)
  [[nodiscard]] virtual bool begin(const Start& start) noexcept = 0;

  /// Changes the level of the motions to come, and forgets all notes. Precondition: as for
  /// traversal().
  virtual void begin_again(double level) noexcept = 0;

  /// Returns true if the region is known to hold no triangle.
  virtual bool region_is_empty() const noexcept = 0;

  /// Shows the visitor each triangle that the motion may come within the level of, and perhaps
  /// others. It may leave out those that it surely meets later than the fraction that the visitor
  /// returned last, but it shows all that may be within the level at the start of the motion. Once
  /// the budget is spent it stops, and triangles may have been left out.
  ///
  /// Returns true if neither this motion, nor any other that ends within `alike` times the motion's
  /// length of its end, comes near a triangle. Precondition: begin() returned true, and
  /// region_is_empty() is false.
  virtual bool traversal(const Vec3& motion, TriangleVisitor& visitor) noexcept = 0;

  /// The distance of the ends of two motions that are equally free, as a fraction of their length.
  static constexpr double alike = 1e-7;

  /// Returns the largest number of triangles that may have notes at the same time.
  virtual std::size_t room() const noexcept = 0;
};

/// Returns the index's own traversal, or, if it has none, one that shows all of its exact hits in
/// the region; within the neighborhood's budget. The neighborhood must outlive it.
std::unique_ptr<MotionTraversal> make_motion_traversal(Neighborhood& neighborhood);

}  // namespace keepout
