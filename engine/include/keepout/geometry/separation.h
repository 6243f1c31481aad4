// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <utility>

#include "keepout/geometry/convex_tool.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

/// How a tool and a triangle lie to one another.
struct Separation {
  double distance;  // above 0: how far apart; below 0: the shortest motion that parts them [length]
  Vec3 normal;      // unit, from the triangle to the tool; below 0 the way that parts them
  Vec3 on_triangle;  // the nearest point of the triangle, or the one that is deepest in the tool

  /// The nearest point of the tool, or the one that is deepest beyond the triangle. [length]
  Vec3 on_tool() const noexcept { return on_triangle + distance * normal; }
};

/// How far a plane with the unit normal n, the triangle behind it, keeps the two apart: min over
/// the tool of n . p - max over the triangle of n . v. Whatever n, that is no more than their
/// distance; below 0, its negative is no less than their depth. Some roundings of the lengths
/// between them.
double separation_along(const Vec3& n, const ConvexTool& tool, const Vec3& position,
                        const Triangle& triangle) noexcept;

/// The distance between a triangle and the tool whose origin is at `position`, or how deep they are
/// in one another: the exact kernel to which every other narrow phase is held.
///
/// Apart, the nearest point of the cores' difference (Gilbert, Johnson, Keerthi 1988, with
/// closest_point for the simplices), whose distance a plane then proves. Where the cores overlap,
/// the least of all depths that can be one: along the faces' normals of both and the cross products
/// of their edges. Triangles without an area are the segments or points that they are. Of normals
/// equally good the first is told, in a fixed order: which may depend on the winding.
///
/// The distance is within some 1e-15 of the lengths at hand, and never more than a plane proves:
/// among lengths of many orders of magnitude it may be some 1e-9 of the largest too small. The
/// depth is as exact, but where edges are parallel to within a, not 0: 1e-16 / a. A sphere's
/// distance is that of closest_point to its centre, less the radius, to the bit. Takes some us
/// apart; some 100 us in an overlap with a tool of 64 points. Allocates nothing. Preconditions:
/// finite, no length above 1e30.
Separation separation(const ConvexTool& tool, const Vec3& position,
                      const Triangle& triangle) noexcept;

/// What a narrow phase says of a pair.
struct NarrowPhaseAnswer {
  Separation separation;     // meaningful only when answered
  std::string_view failure;  // why there is no answer; empty when there is one

  /// Whether there is a separation.
  bool answered() const noexcept { return failure.empty(); }

  /// No answer. `why`: what was wrong; must outlive the answer, as a literal does.
  static NarrowPhaseAnswer failed(std::string_view why) noexcept {
    return {{0.0, Vec3::Zero(), Vec3::Zero()}, why};
  }
};

/// Tells how one tool lies to one triangle after another. Not thread-safe: one for each thread.
///
/// No rule takes an answer at its word, so a wrong one can cost motion but not safety.
class NarrowPhase {
 public:
  virtual ~NarrowPhase() = default;

  /// With the tool's origin at `position`. Ends after a bounded time, whatever the input.
  virtual NarrowPhaseAnswer separation(const Vec3& position, const Triangle& triangle) noexcept = 0;
};

/// Whether all numbers are within 1e30 of the origin: what is not, libraries are not asked about.
bool is_in_range(const Vec3& position, const Triangle& triangle) noexcept;

/// The exact kernel: never fails, allocates nothing.
class ExactNarrowPhase final : public NarrowPhase {
 public:
  /// The kernel for one tool.
  explicit ExactNarrowPhase(ConvexTool tool) : tool_(std::move(tool)) {}

  NarrowPhaseAnswer separation(const Vec3& position, const Triangle& triangle) noexcept override;

 private:
  ConvexTool tool_;
};

}  // namespace keepout
