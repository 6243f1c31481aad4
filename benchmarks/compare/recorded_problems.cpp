// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <utility>

#include "compare/agreement.h"
#include "keepout/activation/registry.h"
#include "keepout/error.h"
#include "keepout/fixtures/poses.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/query.h"
#include "keepout/solvers/active_set.h"
#include "keepout/step/motion_constraint.h"

namespace keepout::app {
namespace {

constexpr double margin = 0.2;  // [mm]
constexpr double radius = 5.0;  // [mm] as in the paper

/// Of an arm: some joints turn, and move the tip by their lever, others slide.
TipJacobian::Matrix random_jacobian(Random& random) {
  TipJacobian::Matrix jacobian(3, 7);
  for (Eigen::Index c = 0; c < jacobian.cols(); ++c) {
    jacobian.col(c) = random.uniform(0.5, 2.0) * random.direction();
  }
  return jacobian;
}

}  // namespace

std::vector<RecordedProblem> record_problems(const std::shared_ptr<const Mesh>& mesh,
                                             const std::string& rule, std::size_t count,
                                             std::uint64_t seed) {
  constexpr int approach = 10, strokes_at_once = 64, cycles = 30;
  // A hundred times what it takes if every cycle in contact poses one.
  const std::size_t most_strokes = 100 * (count / (cycles - approach) + 1);
  std::vector<RecordedProblem> posed, kept;
  // Both record into one: damped for the joints, not so for the tip.
  const auto guard_of = [&](double damping) {
    return MotionConstraint(mesh, std::make_unique<PdTree>(mesh), make_activation(rule),
                            std::make_unique<RecordingSolver>(std::make_unique<ActiveSet>(), posed),
                            {.radius = radius, .margin = margin, .damping = damping});
  };
  MotionConstraint of_the_tip = guard_of(0.0);
  MotionConstraint of_joints = guard_of(1e-6);
  const PdTree tree(mesh);
  NearestTriangle nearest(*mesh, tree);
  Random random(seed);

  for (std::size_t stroke = 0; kept.size() < count;) {
    if (stroke >= most_strokes) {
      throw Error("of " + std::to_string(count) + " problems in contact only " +
                  std::to_string(kept.size()) + " were posed, under " + rule +
                  ", by motions of 0.05 to 0.2 mm half a millimetre off the mesh: is it in another "
                  "unit, or too large or too narrow for them? Scale it to millimetres");
    }
    for (const Vec3& start : surface_points(*mesh, strokes_at_once, 0.5, random)) {
      const bool joints = stroke++ % 3 == 2;
      const TipJacobian::Matrix jacobian = random_jacobian(random);
      const Vec3 press = nearest(start).closest.offset.normalized();
      Vec3 tip = start;
      for (int cycle = 0; cycle < cycles && kept.size() < count; ++cycle) {
        Motion motion{
            .tip = tip,
            .desired = random.uniform(0.05, 0.2) * (press + random.direction()).normalized()};
        if (joints) motion.jacobian = jacobian;
        posed.clear();
        tip += (joints ? of_joints : of_the_tip).step(motion).motion;
        if (cycle >= approach) std::ranges::move(posed, std::back_inserter(kept));
      }
    }
  }
  kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(count), kept.end());
  return kept;
}

void contradict(RecordedProblem& problem, Random& random) {
  const Eigen::Index n = problem.jacobian.cols();
  const Eigen::Index m = problem.rows.rows();
  const double size = problem.desired.norm() / problem.jacobian.norm();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(n);
  double bound = 0;
  for (Eigen::Index i = 0; m > 0 && i < n; ++i) {
    const auto row = static_cast<Eigen::Index>(random.below(static_cast<std::size_t>(m)));
    const double norm = problem.rows.row(row).norm();
    if (norm == 0) continue;
    const double weight = random.uniform(0.2, 2.0) / norm;
    sum += weight * problem.rows.row(row).transpose();
    bound += weight * problem.bounds[row];
  }
  const bool alone = sum.norm() < 1e-3;
  if (alone) {
    for (double& x : sum) x = random.uniform(-1.0, 1.0);
    bound = 0;
  }
  const double beyond = size * std::pow(10.0, random.uniform(-6.0, 0.0)) * sum.norm();
  const Eigen::Index more = alone ? 2 : 1;
  problem.rows.conservativeResize(m + more, n);
  problem.bounds.conservativeResize(m + more);
  problem.rows.row(m) = -sum.transpose();
  problem.bounds[m] = beyond - bound;
  if (!alone) return;
  problem.rows.row(m + 1) = sum.transpose();
  problem.bounds[m + 1] = 0;
}

}  // namespace keepout::app
