// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "keepout/buffer.h"
#include "keepout/geometry/ball.h"
#include "keepout/geometry/closest_point.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// A triangle that touches the query ball, and its point nearest to the centre.
struct Hit {
  TriangleId triangle;   // its number
  ClosestPoint closest;  // relative to the ball's centre
};

/// Hits, with a declared capacity.
using HitBuffer = Buffer<Hit>;

/// From candidates to exact hits: keeps the triangles within the ball (distance <= radius) and
/// sorts them by id, so that nothing downstream depends on the order of a traversal.
void refine(const Mesh& mesh, const Ball& ball, std::span<const TriangleId> candidates,
            HitBuffer& hits) noexcept;

}  // namespace keepout
