// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/refine.h"

#include <algorithm>

namespace keepout {

void refine(const Mesh& mesh, const Ball& ball, std::span<const TriangleId> candidates,
            HitBuffer& hits) noexcept {
  for (const TriangleId t : candidates) {
    const ClosestPoint closest = closest_point(mesh.triangle(t), ball.center);
    if (closest.distance <= ball.radius) hits.push({t, closest});
  }
  std::sort(hits.begin(), hits.end(),
            [](const Hit& a, const Hit& b) { return a.triangle < b.triangle; });
}

}  // namespace keepout
