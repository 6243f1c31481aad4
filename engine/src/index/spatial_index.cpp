// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/spatial_index.h"

#include <algorithm>
#include <cmath>

#include "keepout/error.h"
#include "keepout/rounding_mode.h"

namespace keepout {

SpatialIndex::SpatialIndex(std::shared_ptr<const Mesh> mesh) : mesh_(std::move(mesh)) {
  require_rounding_to_nearest();
  if (mesh_ == nullptr) throw Error("an index needs a mesh, but it is null");
}

void SpatialIndex::collect_near(const Capsule& capsule, TriangleBuffer& candidates) const noexcept {
  // Pieces twice as long as the capsule is thick: shorter pieces need more queries, longer ones
  // find more triangles beside the capsule. The round ends follow.
  constexpr int most_pieces = 64;
  const Vec3 along = capsule.to - capsule.from;
  const double length = along.norm();
  const double wanted = std::ceil(length / (2.0 * capsule.radius + 1e-3 * length));
  const int pieces = wanted < most_pieces ? std::max(static_cast<int>(wanted), 1) : most_pieces;
  const double half = 0.5 * length / pieces;
  const double around_piece = std::sqrt(half * half + capsule.radius * capsule.radius);
  const std::size_t before = candidates.size();
  for (int i = 0; i < pieces + 2 && !candidates.overflowed(); ++i) {
    const bool is_end = i >= pieces;
    const double share = is_end ? i - pieces : (i + 0.5) / pieces;
    const double radius = is_end ? capsule.radius : around_piece;
    collect({capsule.from + share * along, radius * (1.0 + 1e-12)}, candidates);
    if (candidates.overflowed()) break;
    TriangleId* const first = candidates.begin() + before;
    std::sort(first, candidates.end());
    candidates.shrink(
        static_cast<std::size_t>(std::unique(first, candidates.end()) - candidates.begin()));
  }
  // An overflow may come from duplicates near two pieces. One query without duplicates may fit.
  if (candidates.overflowed()) {
    candidates.shrink(before);
    const double all = 0.5 * length + capsule.radius;
    collect({capsule.from + 0.5 * along, all * (1.0 + 1e-12)}, candidates);
  }
}

}  // namespace keepout
