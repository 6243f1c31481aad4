// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "keepout/index/refine.h"
#include "keepout/index/spatial_index.h"

namespace keepout {

/// The triangle nearest to a point, and its closest point, relative to `point`; ties go to the
/// lowest id. By any index: a ball around the point grows until it touches the mesh. `candidates`
/// then holds, among others, all triangles at that distance. Nothing when they are more than it
/// has room for. Allocates nothing.
///
/// `guess`: a radius worth trying first, such as the last distance plus the way since. [length]
/// Precondition: the point is finite.
std::optional<Hit> find_nearest(const Mesh& mesh, const SpatialIndex& index, const Vec3& point,
                                double guess, TriangleBuffer& candidates) noexcept;

/// The same with memory that grows as needed: for measuring, not for the control path.
class NearestTriangle {
 public:
  /// Both must outlive this object.
  NearestTriangle(const Mesh& mesh, const SpatialIndex& index);

  /// The nearest triangle; ties, `guess` and precondition as for find_nearest. Allocates.
  Hit operator()(const Vec3& point, double guess = 0.0);

 private:
  const Mesh* mesh_;
  const SpatialIndex* index_;
  TriangleBuffer candidates_;
};

}  // namespace keepout
