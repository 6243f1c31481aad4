// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/workspace.h"

#include <algorithm>
#include <array>

namespace keepout {
namespace {

// What the tip's increment is to itself.
constexpr std::array<double, 9> identity{1, 0, 0, 0, 1, 0, 0, 0, 1};

}  // namespace

Workspace::Workspace(const Capacity& capacity)
    : candidates(capacity.triangles),
      hits(capacity.triangles),
      planes(capacity.planes),
      variables_(std::max<std::size_t>(capacity.variables, 3)),
      rows_(capacity.planes * variables_),
      bounds_(capacity.planes) {}

StepProblem Workspace::pose(const Vec3& desired, const TipJacobian& jacobian,
                            double damping) noexcept {
  const bool joints = jacobian.joints() > 0;
  const Eigen::Index n = joints ? jacobian.joints() : 3;
  const auto m = static_cast<Eigen::Index>(planes.size());
  Eigen::Map<StepProblem::RowMatrix> rows(rows_.data(), m, n);
  for (Eigen::Index p = 0; p < m; ++p) {
    const HalfSpace& plane = planes[p];
    for (Eigen::Index c = 0; c < n; ++c) {
      rows(p, c) = joints ? plane.normal.dot(jacobian.matrix().col(c)) : plane.normal[c];
    }
    bounds_[p] = plane.offset;
  }
  desired_ = desired;
  return {.jacobian = {joints ? jacobian.data() : identity.data(), 3, n},
          .desired = {desired_.data(), 3},
          .rows = {rows_.data(), m, n},
          .bounds = {bounds_.data(), m},
          .damping = damping};
}

}  // namespace keepout
