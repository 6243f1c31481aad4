// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "keepout/geometry/shapes.h"
#include "keepout/ids.h"

namespace keepout {

class Neighborhood;

/// Receives the triangles that a traversal finds.
class TriangleVisitor {
 public:
  /// Visits a triangle. `note`: a number that the visitor may write, and that the traversal keeps
  /// for the triangle. It is MotionTraversal::no_note for a new triangle, or if the traversal had
  /// to forget the note. `corners`: relative to the tip, in lexicographic order of the mesh's
  /// coordinates; null if there is a note, as the visitor then knows them. [length]
  ///
  /// Returns the fraction of the motion after which triangles no longer matter. It never grows from
  /// call to call. It is negative after a triangle that is within the level at the start.
  virtual double visit(TriangleId triangle, std::uint32_t& note,
                       const Triangle* corners) noexcept = 0;

 protected:
  ~TriangleVisitor() = default;
};

/// Finds the triangles near straight motions that start at one tip, motion after motion (the
/// traversal of docs/certified-step.md). The visitor judges each triangle by its own arithmetic, in
/// any order. So answers do not depend on the traversal, or on what it remembers, unless the work
/// budget ends. An index may offer a traversal that is faster than a query for all triangles in the
/// region (SpatialIndex::traverse_along_motions).
class MotionTraversal {
 public:
  /// The data that all motions of a cycle share.
  struct Start {
    Vec3 tip;        // the start of each motion [length]
    Ball region;     // touches every triangle that a motion may come within `level` of
    double level;    // the distance within which a triangle is near [length]
    double longest;  // upper bound of the length of each motion [length]
  };

  /// The note of a triangle before the visitor writes one.
  static constexpr std::uint32_t no_note = ~std::uint32_t{0};
  /// A fraction after the end of every motion.
  static constexpr double never = 2.0;

  virtual ~MotionTraversal() = default;

  /// Begins a cycle, whose motions all start at one tip; no triangle has a note. Returns false if
  /// the triangles in the region exceed the capacity or the budget. Then the caller must not
  /// conclude that a motion is free. (A traversal that does not make a query may always return
  /// true.)
  [[nodiscard]] virtual bool begin(const Start& start) noexcept = 0;

  /// Changes the level of later motions, and forgets all notes. Precondition: as for traversal().
  virtual void begin_again(double level) noexcept = 0;

  /// Returns true if the region is known to hold no triangle.
  virtual bool region_is_empty() const noexcept = 0;

  /// Shows the visitor each triangle that the motion may come within the level of, and perhaps
  /// others. It always shows the triangles that may be within the level at the start of the motion.
  /// It may skip triangles whose contact is surely later than the fraction that the visitor
  /// returned last. It stops once the budget is spent; triangles may then be missing.
  ///
  /// Returns true if neither this motion nor any similar one comes near a triangle. A motion is
  /// similar if the ends of both motions are at most `alike` times the motion's length apart.
  /// Precondition: begin() returned true, and region_is_empty() is false.
  virtual bool traversal(const Vec3& motion, TriangleVisitor& visitor) noexcept = 0;

  /// The largest distance between the ends of two similar motions, as a fraction of their length.
  static constexpr double alike = 1e-7;

  /// Returns the largest number of triangles that may have notes at the same time.
  virtual std::size_t room() const noexcept = 0;
};

/// Returns the index's own traversal. If the index has none, returns a traversal that shows all
/// exact hits in the region. The traversal spends work units of the neighborhood's budget. The
/// neighborhood must outlive the traversal.
std::unique_ptr<MotionTraversal> make_motion_traversal(Neighborhood& neighborhood);

}  // namespace keepout
