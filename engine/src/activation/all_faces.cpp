// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/all_faces.h"

#include "keepout/activation/planes.h"

namespace keepout {

Opening AllFaces::open(const CycleProblem& problem, HalfSpaceBuffer& planes) noexcept {
  for (const Hit& hit : hits()) {
    const Vec3 normal = mesh().normal(hit.triangle);
    if (normal.isZero(0.0) || !on_positive_side(problem, hit, normal)) continue;
    planes.push(plane_through(hit, normal, problem.clearance));
  }
  return {};
}

}  // namespace keepout
