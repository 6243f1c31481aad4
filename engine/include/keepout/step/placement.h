// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Where a tip is that no step has led to: at the start, or after the caller has moved it.
struct Placement {
  enum class Side : std::uint8_t { free, forbidden };
  Side side;
  double distance;  // from the surface [length]
  Vec3 way_out;     // unit vector: to the surface from the forbidden side, off it from the free one
  Vec3 normal;      // unit vector: of the surface at its nearest point
};

/// Places a tip by the winding of the nearest triangles: on a watertight mesh that does not cut
/// through itself, the sum of their normals, weighted by their angles at the closest point, tells
/// the side (Baerentzen, Aanaes, "Signed distance computation using the angle weighted
/// pseudonormal", IEEE TVCG 11, 2005). The same whatever the order of triangles and corners.
/// Nothing when more triangles are about as near than `candidates` has room for. Allocates nothing.
///
/// Precondition: is_watertight(mesh).
std::optional<Placement> place(const Mesh& mesh, const SpatialIndex& index, const Vec3& tip,
                               TriangleBuffer& candidates) noexcept;

/// A cycle's way from the forbidden side out through the nearest point of the surface, straight.
/// The depth falls by its length, or the tip ends within that length on the free side.
/// `recovery`: the longest way of a cycle. [length]
Vec3 lead_out(const Placement& placement, double recovery) noexcept;

}  // namespace keepout
