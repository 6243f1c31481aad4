// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "keepout/mesh/mesh.h"

namespace keepout {

/// Cuts a polygon of three corners or more into two triangles less than it has corners, wound as it
/// is, and appends them: a fan where it is convex, else ears (Meisters 1975), as seen along its
/// mean normal. What crosses itself or has no area is cut somehow. False, and nothing is appended,
/// if the polygon is not convex and has more than most_ear_corners.
bool cut_polygon(std::span<const VertexId> polygon, std::span<const Vec3> vertices,
                 std::vector<Corners>& triangles);

/// Ears take a time that grows with the third power of the corners.
constexpr std::size_t most_ear_corners = 1000;

}  // namespace keepout
