// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/all_faces.h"

#include "keepout/activation/planes.h"

namespace keepout {

Opening AllFaces::open(const RuleInput& input, HalfSpaceBuffer& planes) noexcept {
  for (const Hit& hit : hits()) {
    const Vec3 normal = mesh().normal(hit.triangle);
    if (normal.isZero(0.0) || !on_positive_side(input, hit, normal)) continue;
    planes.push(plane_through(hit, normal, input.clearance));
  }
  return {};
}

}  // namespace keepout
