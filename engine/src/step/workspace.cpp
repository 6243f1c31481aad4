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
      variables_(static_cast<Eigen::Index>(std::max<std::size_t>(capacity.variables, 3))),
      rows_(capacity.planes * static_cast<std::size_t>(variables_)),
      bounds_(capacity.planes) {}

StepProblem Workspace::pose(const Motion& motion, double damping) noexcept {
  const TipJacobian jacobian = motion.jacobian.value_or(TipJacobian(identity.data(), 3));
  const Eigen::Index n = jacobian.joints();
  const auto m = static_cast<Eigen::Index>(planes.size());
  Eigen::Map<StepProblem::RowMatrix> rows(rows_.data(), m, n);
  for (Eigen::Index p = 0; p < m; ++p) {
    const HalfSpace& plane = planes[p];
    for (Eigen::Index c = 0; c < n; ++c) {
      rows(p, c) = motion.jacobian ? plane.normal.dot(jacobian.matrix().col(c)) : plane.normal[c];
    }
    bounds_[p] = plane.offset;
  }
  desired_ = motion.desired;
  return {.jacobian = {jacobian.data(), 3, n},
          .desired = {desired_.data(), 3},
          .rows = {rows_.data(), m, n},
          .bounds = {bounds_.data(), m},
          .damping = damping};
}

}  // namespace keepout
