// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "keepout/index/refine.h"
#include "keepout/index/spatial_index.h"

namespace keepout {

/// The triangle nearest to a point, and its closest point, relative to `point`; ties go to the
/// lowest id. Of every index the same, bit for bit. One that has no search of its own for it
/// (SpatialIndex::nearest) is asked about a ball around the point that grows until it touches the
/// mesh: far from it that may be a large part of it, and there is no answer when it is more than
/// `candidates` has room for. Allocates nothing.
///
/// `guess`: for such an index a radius worth trying first, such as the last distance plus the way
/// since. [length] Precondition: the point is finite.
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
