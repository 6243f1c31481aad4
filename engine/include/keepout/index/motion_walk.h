// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "keepout/geometry/shapes.h"
#include "keepout/ids.h"

namespace keepout {

class Neighborhood;

/// A triangle that a walk along a motion comes by.
struct Encounter {
  /// What a note is before the visitor writes one.
  static constexpr std::uint32_t no_note = ~std::uint32_t{0};

  TriangleId triangle;  // its number
  /// The visitor's own memory of the triangle; it lasts until the walk begins anew.
  std::uint32_t& note;
  /// The corners relative to the tip, in lexicographic order of the mesh's coordinates; null where
  /// there is a note, for then the visitor knows them. [length]
  const Triangle* corners;
};

/// What is shown the triangles on the way.
class EncounterVisitor {
 public:
  /// Returns the share of the motion after which triangles matter no more; it never grows.
  virtual double visit(const Encounter& its) noexcept = 0;

 protected:
  ~EncounterVisitor() = default;
};

/// A source of triangles: finds those in the way of straight motions that start at one tip, motion
/// after motion. Whoever asks decides what they mean, by arithmetic of its own, in whatever order
/// they come: so answers do not depend on the source, and nothing that a source remembers changes
/// them. An index may offer one that is faster than a query for all that is near
/// (SpatialIndex::walk_along_motions).
class MotionWalk {
 public:
  /// What the motions to come have in common.
  struct Start {
    Vec3 tip;        // where they start [length]
    Ball region;     // holds all that they may come within `level` of
    double level;    // how near is near [length]
    double longest;  // none is longer [length]
  };

  virtual ~MotionWalk() = default;

  /// From here on motions are these, and no triangle has a note. False if the region holds more
  /// than there is room for, or than the budget allows to look at: then nothing may be concluded
  /// until a walk begins well.
  [[nodiscard]] virtual bool begin(const Start& start) noexcept = 0;

  /// The same motions again, with another level and without notes.
  virtual void begin_again(double level) noexcept = 0;

  /// Whether it is known that the region holds no triangle.
  virtual bool is_free() const noexcept = 0;

  /// Shows the visitor each triangle that the motion may come within the level of, and perhaps
  /// others, but for those that it surely meets later than matters. True if it is known that the
  /// motion, and any other that ends within `alike` of it, comes near none, as a share of it. Once
  /// the budget is spent it stops, and triangles may have been left out.
  virtual bool walk(const Vec3& motion, EncounterVisitor& visitor) noexcept = 0;

  /// How near two motions end to each other that are as free, as a share of the first.
  static constexpr double alike = 1e-7;

  /// How many triangles may be given notes between two beginnings.
  virtual std::size_t room() const noexcept = 0;
};

/// The index's own walk, or, of one that has none, a visit to all of its exact hits in the region;
/// within the neighbourhood's budget. The neighbourhood must outlive it.
std::unique_ptr<MotionWalk> make_motion_walk(Neighborhood& near);

}  // namespace keepout
