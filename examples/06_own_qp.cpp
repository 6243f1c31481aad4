// SPDX-License-Identifier: BSD-3-Clause
// The free polytope around the tip in a quadratic program of your own: a controller that plans some
// cycles ahead, smoothly, within the polytope. Every motion within it maintains the required
// clearance.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "keepout/index/query.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/keepout.h"
#include "keepout/solvers/active_set.h"

using Vector = Eigen::VectorXd;

/// Model predictive control of a point. With p_k = d_1 + ... + d_k, the position after k moves:
///
///   min  sum over k of  |p_k - k wish|^2 + smoothness |d_k - d_(k-1)|^2
///   subject to  normal . p_k >= offset for all planes, |each coordinate of p_k| <= side
///
/// Any solver of convex quadratic programs is suitable. This example uses keepout's own.
class Planner {
 public:
  static constexpr int horizon = 5;  // moves
  static constexpr int most_planes = 500;

  explicit Planner(double smoothness) : weight_(std::sqrt(smoothness)) {
    for (int k = 0; k < horizon; ++k) {
      for (int i = 0; i <= k; ++i) block(cost_, k, i) = Eigen::Matrix3d::Identity();
      block(cost_, horizon + k, k) = weight_ * Eigen::Matrix3d::Identity();
      if (k > 0) block(cost_, horizon + k, k - 1) = -weight_ * Eigen::Matrix3d::Identity();
    }
    solver_.reserve(3 * horizon, static_cast<int>(rows_.rows()));
  }

  /// Returns the first move of the best plan, or nothing if there is no plan.
  keepout::Vec3 move(const keepout::Polytope& free, double side, const keepout::Vec3& wish,
                     const keepout::Vec3& last) {
    if (free.planes.size() > most_planes) return keepout::Vec3::Zero();
    for (int k = 0; k < horizon; ++k) target_.segment<3>(3 * k) = (k + 1) * wish;
    target_.segment<3>(3 * horizon) = weight_ * last;
    Eigen::Index row = 0;
    for (int k = 0; k < horizon; ++k) {
      for (const auto& plane : free.planes) constrain(row++, k, plane.normal, plane.offset);
      for (int axis = 0; axis < 3; ++axis) {
        constrain(row++, k, keepout::Vec3::Unit(axis), -side);
        constrain(row++, k, -keepout::Vec3::Unit(axis), -side);
      }
    }
    const keepout::StepProblem problem{.jacobian = {cost_.data(), cost_.rows(), cost_.cols()},
                                       .desired = {target_.data(), target_.size()},
                                       .rows = {rows_.data(), row, rows_.cols()},
                                       .bounds = {bounds_.data(), row}};
    keepout::Solution plan;
    if (solver_.solve(problem, plan) != keepout::SolveStatus::optimal) return keepout::Vec3::Zero();
    return {plan.u[0], plan.u[1], plan.u[2]};
  }

 private:
  using Matrix = keepout::StepProblem::Matrix;
  using RowMatrix = keepout::StepProblem::RowMatrix;

  static Eigen::Block<Matrix, 3, 3> block(Matrix& matrix, int row, int column) {
    return matrix.block<3, 3>(3 * row, 3 * column);
  }

  /// direction . p_k >= bound
  void constrain(Eigen::Index row, int k, const keepout::Vec3& direction, double bound) {
    rows_.row(row).setZero();
    for (int i = 0; i <= k; ++i) rows_.row(row).segment<3>(3 * i) = direction.transpose();
    bounds_[row] = bound;
  }

  double weight_;
  Matrix cost_ = Matrix::Zero(6 * horizon, 3 * horizon);
  Vector target_ = Vector::Zero(6 * horizon);
  RowMatrix rows_ = RowMatrix::Zero(horizon * (most_planes + 6), 3 * horizon);
  Vector bounds_ = Vector::Zero(rows_.rows());
  keepout::ActiveSet solver_;
};

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s MESH\n", argv[0]);
    return 2;
  }
  const auto mesh = keepout::load_mesh(argv[1]).mesh;
  constexpr double margin = 0.5, radius = 2.0;  // [length]
  auto guard =
      keepout::make_motion_constraint(mesh, {.options = {.radius = radius, .margin = margin}});
  Planner planner(4.0);

  // The commanded motion starts above the mesh and goes straight down through it. The clearance is
  // measured independently.
  const keepout::WideBvh index(mesh);
  keepout::NearestTriangle nearest(*mesh, index);
  const keepout::Box& box = mesh->bounds();
  keepout::Vec3 tip(box.center().x(), box.center().y(), box.high.z() + 5.0);
  const keepout::Vec3 goal(tip.x() + 1.0, tip.y(), box.low.z());
  keepout::Vec3 last = keepout::Vec3::Zero();
  double closest = 1e9, jerk = 0.0;  // [length]
  constexpr int cycles = 500;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    // The largest cube in the ball in which the polytope is valid.
    const keepout::Vec3 move =
        planner.move(guard.free_polytope(tip, radius), radius / std::sqrt(3.0),
                     0.2 * (goal - tip).normalized(), last);
    jerk = std::max(jerk, (move - last).norm());
    last = move;
    tip += move;
    closest = std::min(closest, nearest(tip).closest.distance);
  }
  std::printf("closest %.9f of %.1f, largest change of a move %.3f, ends at %.6f %.6f %.6f\n",
              closest, margin, jerk, tip.x(), tip.y(), tip.z());
  return closest >= margin - 1e-9 ? 0 : 1;
} catch (const keepout::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
