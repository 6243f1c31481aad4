// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "keepout/geometry/vec3.h"

namespace keepout {

/// Unit vectors, one of each opposite pair.
struct HullDirections {
  std::vector<Vec3> faces;  // at least the normals of the hull's faces
  std::vector<Vec3> edges;  // at least the directions of its edges
};

/// Of the convex hull of the points, which may be flat, straight or a point. Tries every triple, so
/// that no degeneracy needs care: O(n^4), 10 ms for 64 points.
HullDirections hull_directions(std::span<const Vec3> points);

}  // namespace keepout
