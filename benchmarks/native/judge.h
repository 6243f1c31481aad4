// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <tuple>
#include <vector>

#include "keepout/error.h"
#include "keepout/mesh/mesh.h"
#include "keepout/oracle/best_step.h"
#include "keepout/oracle/safety_oracle.h"

namespace keepout::peers {

/// Points or motions, one in each row. [length]
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using RowsRef = Eigen::Ref<const Rows>;

/// Judges many motions of a tip with the oracle, whose arithmetic and search are independent. The
/// answers do not depend on the order of the motions; it is fastest if each is near the last.
class Judge {
 public:
  explicit Judge(const std::shared_ptr<const Mesh>& mesh)
      : oracle_(mesh), closed_(oracle_.inside(oracle_.tree()->bounds().low).has_value()) {}

  /// Returns true if the mesh has an inside.
  bool closed() const { return closed_; }

  /// Returns the oracle, which judges one motion.
  oracle::SafetyOracle& oracle() noexcept { return oracle_; }

  /// Returns the distance of each point from the mesh, below 0 inside a closed mesh. [length]
  Eigen::VectorXd distances(const RowsRef& points) {
    require_finite(points.allFinite());
    Eigen::VectorXd out(points.rows());
    bool is_inside = false;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      const Vec3 point = points.row(i);
      // A segment that does not touch the mesh stays on one side of it.
      const bool may_differ =
          i == 0 || (closed_ && oracle_.check(points.row(i - 1), point, 0.0).crosses);
      if (closed_ && may_differ) is_inside = *oracle_.inside(point);
      const double distance = oracle_.distance(point);
      out[i] = is_inside ? -distance : distance;
    }
    return out;
  }

  /// Returns which straight motions touch the mesh, exactly.
  Eigen::Array<bool, Eigen::Dynamic, 1> crossings(const RowsRef& starts, const RowsRef& ends) {
    Eigen::Array<bool, Eigen::Dynamic, 1> out(require_pairs(starts, ends));
    for (Eigen::Index i = 0; i < starts.rows(); ++i) {
      out[i] = oracle_.check(starts.row(i), ends.row(i), 0.0).crosses;
    }
    return out;
  }

  /// Returns the best safe step, its cost, and a lower bound of the cost of any safe step:
  /// oracle/best_step.h. Throws Error if the tip is on the mesh.
  std::tuple<Vec3, double, double> best_step(const Vec3& tip, const Vec3& desired, double margin) {
    require_finite(tip.allFinite() && desired.allFinite());
    if (oracle_.distance(tip) == 0.0) throw Error("a tip on the mesh has no best step");
    const Vec3 middle = tip + 0.5 * desired;
    std::vector<TriangleId> near;
    oracle_.tree()->collect_within(0.5 * desired.norm() + 1.001 * margin, {middle, middle}, near);
    const oracle::BestStep best =
        oracle::best_step(oracle_.tree()->mesh(), near, tip, desired, margin);
    return {best.motion, best.cost, best.bound};
  }

 private:
  /// Returns the number of pairs.
  static Eigen::Index require_pairs(const RowsRef& starts, const RowsRef& ends) {
    if (starts.rows() != ends.rows()) throw Error("each start needs an end, and each end a start");
    return starts.rows();
  }
  static void require_finite(bool is_finite) {
    if (!is_finite) throw Error("points and motions must be finite");
  }

  oracle::SafetyOracle oracle_;
  bool closed_;
};

}  // namespace keepout::peers
