// SPDX-License-Identifier: BSD-3-Clause
#include "verify/tip_joints.h"

#include <cmath>

namespace keepout::app {

TipJoints::TipJoints(const Setup& setup, Random& random)
    : random_(&random),
      has_limits_(setup.has_limits),
      longest_(setup.longest_step),
      jacobian_(3, setup.joints) {}

void TipJoints::draw() {
  const double scale = std::pow(10.0, random_->uniform(-1.0, 2.0));
  const double spread =
      random_->uniform() < 0.3 ? std::pow(10.0, random_->uniform(-8.0, 0.0)) : 1.0;
  const Eigen::Index n = jacobian_.cols();
  const Vec3 common = random_->direction();
  for (Eigen::Index c = 0; c < n; ++c) {
    // All joints may do nearly the same: far from the tip, or near a singular pose.
    const Vec3 own = random_->direction();
    jacobian_.col(c) = scale * (spread < 1.0 ? Vec3(common + spread * own) : own);
  }
  rows_.fill(0.0);
  for (Eigen::Index c = 0; c < n; ++c) {
    const double limit = longest_ / scale * std::pow(10.0, random_->uniform(-1.0, 1.0));
    for (int side = 0; side < 2; ++side) {
      const auto row = static_cast<std::size_t>(2 * c + side);
      rows_[row * static_cast<std::size_t>(n) + static_cast<std::size_t>(c)] =
          side == 0 ? 1.0 : -1.0;
      bounds_[row] = -limit;
    }
  }
}

void TipJoints::attach(Motion& motion) {
  if (jacobian_.cols() == 0) return;
  if (cycle_++ % 40 == 0) draw();
  motion.jacobian = TipJacobian(jacobian_);
  if (has_limits_) motion.rows = ExtraRows(rows_.data(), bounds_.data(), 2 * jacobian_.cols());
}

}  // namespace keepout::app
