// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/spatial_index.h"

#include <algorithm>
#include <cmath>

#include "keepout/error.h"

namespace keepout {

SpatialIndex::SpatialIndex(std::shared_ptr<const Mesh> mesh) : mesh_(std::move(mesh)) {
  if (mesh_ == nullptr) throw Error("an index needs a mesh: none was given");
}

void SpatialIndex::collect_near(const Capsule& capsule, TriangleBuffer& candidates) const noexcept {
  // Pieces twice as long as the capsule is thick: shorter ones ask for more, longer ones find more
  // that is beside it.
  constexpr double most_pieces = 64.0;
  const double length = (capsule.to - capsule.from).norm();
  const double wanted = std::ceil(length / (2.0 * capsule.radius + 1e-3 * length));
  const double pieces = std::clamp(wanted, 1.0, most_pieces);
  const double half = 0.5 * length / pieces;
  const double radius = std::hypot(half, capsule.radius) * (1.0 + 1e-12);
  const std::size_t before = candidates.size();
  const auto add = [&](const Ball& ball) {
    if (candidates.overflowed()) return;
    const std::size_t known = candidates.size();
    collect(ball, candidates);
    if (known == before || candidates.overflowed()) return;
    TriangleId* const first = candidates.begin() + before;
    std::sort(first, candidates.end());
    const auto found = std::unique(first, candidates.end()) - candidates.begin();
    candidates.shrink(before + static_cast<std::size_t>(found));
  };
  for (double piece = 0.5; piece < pieces; piece += 1.0) {
    add({capsule.from + piece / pieces * (capsule.to - capsule.from), radius});
  }
  // The round ends, beyond the outermost pieces.
  if (length > 0.0) {
    for (const Vec3& end : {capsule.from, capsule.to}) add({end, capsule.radius * (1.0 + 1e-12)});
  }
  // There may have been room for each once, but not for what is near two pieces.
  if (candidates.overflowed()) {
    candidates.shrink(before);
    const double all = 0.5 * length + capsule.radius;
    collect(Ball{0.5 * (capsule.from + capsule.to), all * (1.0 + 1e-12)}, candidates);
  }
}

}  // namespace keepout
