// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <utility>

#include "keepout/geometry/convex_tool.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

/// The signed distance of a tool and a triangle.
struct Separation {
  double distance;  // above 0: how far apart; below 0: the shortest motion that parts them [length]
  Vec3 normal;      // unit, from the triangle to the tool; below 0 the direction that parts them
  Vec3 on_triangle;  // the nearest point of the triangle, or the one that is deepest in the tool

  /// The nearest point of the tool, or the one that is deepest beyond the triangle. [length]
  Vec3 on_tool() const noexcept { return on_triangle + distance * normal; }
};

/// Returns the distance that a plane with the unit normal n proves, the triangle behind it: min
/// over the tool of n . p - max over the triangle of n . v. For any n it is at most their distance;
/// below 0, its negative is at least their depth. Exact to some roundings of the lengths between
/// them.
double separation_along(const Vec3& n, const ConvexTool& tool, const Vec3& position,
                        const Triangle& triangle) noexcept;

/// Returns the signed distance between a triangle and the tool whose origin is at `position`: the
/// exact kernel, the reference for every other narrow phase.
///
/// Apart: the nearest point of the cores' difference (Gilbert, Johnson, Keerthi 1988, with
/// closest_point for the simplices). A plane then proves its distance. Overlapping cores: the least
/// depth along the face normals of both and the cross products of their edges. A triangle without
/// an area is treated as a segment or a point. Of equally good normals it returns the first in a
/// fixed order, which may depend on the winding.
///
/// The distance is within some 1e-15 of the lengths at hand, and never more than a plane proves. If
/// the lengths differ by many orders of magnitude it may be too small by some 1e-9 of the largest.
/// The depth is as exact, but 1e-16 / a if edges are parallel to within an angle a, not 0. A
/// sphere's distance is bitwise closest_point's to its center less the radius. Takes some µs apart,
/// and some 100 µs in an overlap with a tool of 64 points. Allocates nothing. Preconditions:
/// finite, no length above 1e30.
Separation separation(const ConvexTool& tool, const Vec3& position,
                      const Triangle& triangle) noexcept;

/// A narrow phase's result for a pair.
struct NarrowPhaseAnswer {
  Separation separation;     // meaningful only when answered
  std::string_view failure;  // why there is no answer; empty when there is one

  /// Returns true if there is a separation.
  bool answered() const noexcept { return failure.empty(); }

  /// Returns no answer. `why`: the reason, which must outlive the answer, as a literal does.
  static NarrowPhaseAnswer failed(std::string_view why) noexcept {
    return {{0.0, Vec3::Zero(), Vec3::Zero()}, why};
  }
};

/// Computes the separation of one tool from any triangle. Not thread-safe: one for each thread.
/// Rules prove each answer, so a wrong one can cost motion but not safety.
class NarrowPhase {
 public:
  virtual ~NarrowPhase() = default;

  /// With the tool's origin at `position`. Ends after a bounded time, whatever the input.
  virtual NarrowPhaseAnswer separation(const Vec3& position, const Triangle& triangle) noexcept = 0;

  /// Returns true if its answers are those of the exact kernel.
  virtual bool is_exact() const noexcept { return false; }
};

/// Returns true if all numbers are within 1e30 of the origin. Libraries get no others.
bool is_in_range(const Vec3& position, const Triangle& triangle) noexcept;

/// The exact kernel: never fails, allocates nothing.
class ExactNarrowPhase final : public NarrowPhase {
 public:
  /// Makes the kernel of one tool.
  explicit ExactNarrowPhase(ConvexTool tool) : tool_(std::move(tool)) {}

  NarrowPhaseAnswer separation(const Vec3& position, const Triangle& triangle) noexcept override;
  bool is_exact() const noexcept override { return true; }

 private:
  ConvexTool tool_;
};

}  // namespace keepout
