// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <tuple>

#include "keepout/mesh/mesh.h"
#include "keepout/oracle/safety_oracle.h"

namespace keepout::peers {

/// Points or motions, a row each. [length]
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Says what became of a tip, with arithmetic and search of its own: the oracle, for many motions
/// at once. The answers do not depend on their order; the time is least where each is near the
/// last.
class Judge {
 public:
  explicit Judge(const std::shared_ptr<const Mesh>& mesh);

  /// Whether there is an inside.
  bool closed() const { return closed_; }

  /// Of each point from the mesh, less than 0 inside of a closed one. [length]
  Eigen::VectorXd distances(const Eigen::Ref<const Rows>& points);

  /// Of each straight motion from the mesh at its nearest: 0 if and only if it touches, and
  /// infinite where it is more than `reach`. The less the reach, the faster. [length]
  Eigen::VectorXd least_distances(const Eigen::Ref<const Rows>& starts,
                                  const Eigen::Ref<const Rows>& ends, double reach);

  /// Which straight motions touch the mesh, exactly.
  Eigen::Array<bool, Eigen::Dynamic, 1> crossings(const Eigen::Ref<const Rows>& starts,
                                                  const Eigen::Ref<const Rows>& ends);

  /// The best safe step, what it costs, and what a safe one costs at least: oracle/best_step.h.
  /// Throws Error if the tip is on the mesh.
  std::tuple<Vec3, double, double> best_step(const Vec3& tip, const Vec3& desired, double margin);

 private:
  oracle::SafetyOracle oracle_;
  bool closed_;
};

}  // namespace keepout::peers
