// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "keepout/geometry/shapes.h"

namespace keepout {

/// The part of a triangle on which a point lies. Edge e runs from corner e to corner (e + 1) % 3.
enum class Feature : std::uint8_t { face, edge_0, edge_1, edge_2, vertex_0, vertex_1, vertex_2 };

/// Returns true if the feature is the inside of the triangle.
constexpr bool is_face(Feature f) noexcept { return f == Feature::face; }
/// Returns true if the feature is one of the three edges, without its ends.
constexpr bool is_edge(Feature f) noexcept { return f >= Feature::edge_0 && f <= Feature::edge_2; }
/// Returns true if the feature is one of the three corners.
constexpr bool is_vertex(Feature f) noexcept { return f >= Feature::vertex_0; }

/// Returns the number (0, 1, 2) of an edge or a vertex feature. Precondition: not the face.
constexpr int number_of(Feature f) noexcept {
  return static_cast<int>(f) - static_cast<int>(is_vertex(f) ? Feature::vertex_0 : Feature::edge_0);
}

/// The point of a triangle that is nearest to a query.
struct ClosestPoint {
  Vec3 offset;      // from the query to the closest point [length]
  double distance;  // |offset| [length]
  Feature feature;  // on which the closest point lies
};

/// Returns the point of `triangle` nearest to `query`. This is the exact kernel: it decides which
/// triangles touch a ball and which is the nearest, so results do not depend on the index. (The
/// certified rule judges trials by PreparedTriangle.)
///
/// The offset and the distance are bitwise identical for any order of the corners. The error is
/// about 1e-15 of the largest distance from the query to a corner. It does not grow with the
/// distance from the origin, as all arithmetic is relative to the query. A triangle without an area
/// is treated as the segment or point that it is.
ClosestPoint closest_point(const Triangle& triangle, const Vec3& query) noexcept;

/// Like closest_point, for a triangle whose corners are in lexicographic order already.
ClosestPoint closest_point_of_ordered(const Triangle& triangle, const Vec3& query) noexcept;

}  // namespace keepout
