// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <utility>

#include "keepout/geometry/convex_tool.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

/// The signed distance of a tool and a triangle.
struct Separation {
  /// Above 0: the distance. Below 0: minus the length of the shortest motion that separates them.
  /// [length]
  double distance;
  /// The unit vector from the triangle to the tool; if they overlap, the direction that separates
  /// them.
  Vec3 normal;
  /// The nearest point of the triangle, or its point deepest in the tool. [length]
  Vec3 on_triangle;

  /// Returns the nearest point of the tool, or its point deepest beyond the triangle. [length]
  Vec3 on_tool() const noexcept { return on_triangle + distance * normal; }
};

/// Returns the distance that a plane with the unit normal n proves: min n . p over the tool minus
/// max n . v over the triangle. For any n, this distance is at most that of tool and triangle. If
/// it is below 0, its negative is at least their depth. Exact to a few roundings of the lengths
/// between them.
double separation_along(const Vec3& n, const ConvexTool& tool, const Vec3& position,
                        const Triangle& triangle) noexcept;

/// Returns the signed distance between a triangle and the tool whose origin is at `position`. This
/// is the exact kernel, the reference for every other narrow phase.
///
/// If the tool's core and the triangle are apart, the distance is computed by Gilbert, Johnson,
/// Keerthi (1988), with closest_point for the simplices. A plane then proves it. If they overlap,
/// the depth is the least along the face normals of both and the cross products of their edges. A
/// triangle without an area is treated as a segment or a point. Among equally good normals it
/// returns the first in a fixed order, which may depend on the winding.
///
/// The error of the distance is about 1e-15 of the lengths involved, and the distance is never more
/// than a plane proves. If the lengths differ by many orders of magnitude, the distance may be too
/// small by about 1e-9 of the largest. The error of the depth is the same, except if edges are
/// parallel to within an angle a other than 0: then it is 1e-16 / a of these lengths. The distance
/// of a sphere is bitwise that of closest_point() from its center, minus the radius. Takes a few µs
/// if apart, and about 100 µs in an overlap with a tool of 64 points. Does not allocate.
/// Preconditions: all numbers are finite, and no length is above 1e30.
Separation separation(const ConvexTool& tool, const Vec3& position,
                      const Triangle& triangle) noexcept;

/// The result of a narrow phase for a tool and a triangle.
struct NarrowPhaseAnswer {
  Separation separation;     // meaningful only if answered()
  std::string_view failure;  // the cause if there is no answer; else empty

  /// Returns true if there is a separation.
  bool answered() const noexcept { return failure.empty(); }

  /// Returns a result without an answer. `why`: the cause, which must outlive the result, as a
  /// literal does.
  static NarrowPhaseAnswer failed(std::string_view why) noexcept {
    return {{0.0, Vec3::Zero(), Vec3::Zero()}, why};
  }
};

/// Computes the separation of one tool from any triangle. Not thread-safe: make one for each
/// thread. Rules prove each answer, so a wrong answer can cost motion but not safety.
class NarrowPhase {
 public:
  virtual ~NarrowPhase() = default;

  /// Returns the separation of a triangle and the tool with its origin at `position`. Ends after a
  /// bounded time for any input.
  virtual NarrowPhaseAnswer separation(const Vec3& position, const Triangle& triangle) noexcept = 0;

  /// Returns true if the answers are those of the exact kernel.
  virtual bool is_exact() const noexcept { return false; }
};

/// Returns true if all coordinates are within 1e30 of the origin. Other libraries receive only such
/// coordinates.
bool is_in_range(const Vec3& position, const Triangle& triangle) noexcept;

/// The exact kernel as a narrow phase. It never fails and does not allocate.
class ExactNarrowPhase final : public NarrowPhase {
 public:
  /// Makes the kernel for one tool.
  explicit ExactNarrowPhase(ConvexTool tool) : tool_(std::move(tool)) {}

  NarrowPhaseAnswer separation(const Vec3& position, const Triangle& triangle) noexcept override;
  bool is_exact() const noexcept override { return true; }

 private:
  ConvexTool tool_;
};

}  // namespace keepout
