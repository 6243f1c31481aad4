// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>

#include "keepout/fixtures/random.h"
#include "keepout/step/motion.h"
#include "setup.h"

namespace keepout::app {

/// The joints of a robot that moves a tip, and their limits.
class TipJoints {
 public:
  TipJoints(const Setup& setup, Random& random)
      : random_(&random),
        has_limits_(setup.has_limits),
        longest_(setup.longest_step),
        jacobian_(3, setup.joints),
        rows_(Rows::Zero(2 * setup.joints, setup.joints)),
        bounds_(2 * setup.joints) {
    for (int c = 0; c < setup.joints; ++c) rows_.col(c).segment<2>(2 * c) << 1.0, -1.0;
  }

  /// Adds the Jacobian and the limits to a motion. Draws new ones every 40 cycles.
  void attach(Motion& motion) {
    if (jacobian_.cols() == 0) return;
    if (cycle_++ % 40 == 0) draw();
    motion.jacobian = TipJacobian(jacobian_);
    if (has_limits_) motion.rows = ExtraRows(rows_.data(), bounds_.data(), rows_.rows());
  }

 private:
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  void draw() {
    const double scale = std::pow(10.0, random_->uniform(-1.0, 2.0));
    const double spread =
        random_->uniform() < 0.3 ? std::pow(10.0, random_->uniform(-8.0, 0.0)) : 1.0;
    const Vec3 common = random_->direction();
    for (auto column : jacobian_.colwise()) {
      // All joints may have nearly the same effect: far from the tip, or near a singular pose.
      const Vec3 own = random_->direction();
      column = scale * (spread < 1.0 ? Vec3(common + spread * own) : own);
    }
    for (Eigen::Index c = 0; c < jacobian_.cols(); ++c) {
      const double limit = longest_ / scale * std::pow(10.0, random_->uniform(-1.0, 1.0));
      bounds_.segment<2>(2 * c).setConstant(-limit);
    }
  }

  Random* random_;
  bool has_limits_;
  double longest_;  // largest step of the tip [length]
  std::size_t cycle_ = 0;
  TipJacobian::Matrix jacobian_;
  Rows rows_;
  Eigen::VectorXd bounds_;
};

}  // namespace keepout::app
