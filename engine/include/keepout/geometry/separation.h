// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/convex_tool.h"
#include "keepout/geometry/triangle.h"

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
/// The distance is within some 1e-15 of the lengths at hand; the depth as well, but where edges are
/// parallel to within a, not 0: 1e-16 / a. A sphere's distance is that of closest_point to its
/// centre, less the radius, to the bit. Takes some us apart; some 100 us in an overlap with a tool
/// of 64 points. Allocates nothing. Preconditions: finite, no length above 1e30.
Separation separation(const ConvexTool& tool, const Vec3& position,
                      const Triangle& triangle) noexcept;

}  // namespace keepout
