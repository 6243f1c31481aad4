// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/index/refine.h"
#include "keepout/index/spatial_index.h"

namespace keepout {

/// Finds the triangle nearest to a point, by any index: a ball around the point grows until it
/// touches the mesh. Its memory grows as needed, so it is for measuring, not for the control path.
class NearestTriangle {
 public:
  /// Both must outlive this object.
  NearestTriangle(const Mesh& mesh, const SpatialIndex& index);

  /// The nearest triangle and its closest point, relative to `point`; ties go to the lowest id.
  /// `guess`: a radius worth trying first, such as the last distance plus the way since. [length]
  /// Precondition: the point is finite.
  Hit operator()(const Vec3& point, double guess = 0.0);

 private:
  const Mesh* mesh_;
  const SpatialIndex* index_;
  TriangleBuffer candidates_;
};

}  // namespace keepout
