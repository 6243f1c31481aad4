// SPDX-License-Identifier: BSD-3-Clause
#include "judge.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "keepout/error.h"
#include "keepout/oracle/best_step.h"

namespace keepout::peers {
namespace {

void require_pairs(const Eigen::Ref<const Rows>& starts, const Eigen::Ref<const Rows>& ends) {
  if (starts.rows() != ends.rows()) throw Error("each start needs an end, and each end a start");
}

void require_finite(bool is_finite) {
  if (!is_finite) throw Error("points and motions must be finite");
}

}  // namespace

Judge::Judge(const std::shared_ptr<const Mesh>& mesh)
    : oracle_(mesh), closed_(oracle_.inside(oracle_.tree()->bounds().low).has_value()) {}

Eigen::VectorXd Judge::distances(const Eigen::Ref<const Rows>& points) {
  require_finite(points.allFinite());
  Eigen::VectorXd out(points.rows());
  bool is_inside = false;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Vec3 point = points.row(i);
    // A way that does not touch the mesh leads to no other side of it.
    const bool may_differ =
        i == 0 || (closed_ && oracle_.check(points.row(i - 1), point, 0.0).crosses);
    if (closed_ && may_differ) is_inside = *oracle_.inside(point);
    const double distance = oracle_.distance(point);
    out[i] = is_inside ? -distance : distance;
  }
  return out;
}

Eigen::VectorXd Judge::least_distances(const Eigen::Ref<const Rows>& starts,
                                       const Eigen::Ref<const Rows>& ends, double reach) {
  require_pairs(starts, ends);
  require_finite(starts.allFinite() && ends.allFinite());
  const oracle::TriangleTree& tree = *oracle_.tree();
  std::vector<TriangleId> near;
  Eigen::VectorXd out(starts.rows());
  for (Eigen::Index i = 0; i < starts.rows(); ++i) {
    const oracle::Segment motion{starts.row(i), ends.row(i)};
    near.clear();
    const double at_start = oracle_.distance(motion.from);  // of the whole way it is no more
    tree.collect_within(std::min(reach, at_start), motion, near);
    double least = at_start;
    for (const TriangleId t : near) {
      const Triangle triangle = tree.mesh().triangle(t);
      if (oracle::bracket_distance(motion, triangle).low >= least) continue;
      least = std::min(least, oracle::narrow_distance(motion, triangle).estimate);
    }
    out[i] = least <= reach ? least : std::numeric_limits<double>::infinity();
  }
  return out;
}

Eigen::Array<bool, Eigen::Dynamic, 1> Judge::crossings(const Eigen::Ref<const Rows>& starts,
                                                       const Eigen::Ref<const Rows>& ends) {
  require_pairs(starts, ends);
  Eigen::Array<bool, Eigen::Dynamic, 1> out(starts.rows());
  for (Eigen::Index i = 0; i < starts.rows(); ++i) {
    out[i] = oracle_.check(starts.row(i), ends.row(i), 0.0).crosses;
  }
  return out;
}

std::tuple<Vec3, double, double> Judge::best_step(const Vec3& tip, const Vec3& desired,
                                                  double margin) {
  require_finite(tip.allFinite() && desired.allFinite());
  if (oracle_.distance(tip) == 0.0) throw Error("a tip on the mesh has no best step");
  const Vec3 middle = tip + 0.5 * desired;
  std::vector<TriangleId> near;
  oracle_.tree()->collect_within(0.5 * desired.norm() + 1.001 * margin, {middle, middle}, near);
  const oracle::BestStep best =
      oracle::best_step(oracle_.tree()->mesh(), near, tip, desired, margin);
  return {best.motion, best.cost, best.bound};
}

}  // namespace keepout::peers
