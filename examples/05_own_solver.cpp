// SPDX-License-Identifier: BSD-3-Clause
// A solver of your own: Hildreth's method in a motion constraint, checked against the conditions of
// Karush, Kuhn and Tucker and against active_set.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>
#include <vector>

#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/error.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/solvers/kkt.h"
#include "keepout/solvers/recording_solver.h"
#include "keepout/solvers/registry.h"
#include "keepout/step/motion_constraint.h"

/// Finds the point nearest to d that satisfies all rows, by coordinate ascent on the dual: each
/// sweep corrects one multiplier after another. The code is short, but slow if planes are nearly
/// parallel. For the motion of the tip only, without joints. Source: Hildreth, "A quadratic
/// programming procedure", Naval Research Logistics Quarterly 4, 1957.
class Hildreth final : public keepout::Solver {
 public:
  void reserve(int /*variables*/, int rows) override {
    forces_.resize(static_cast<std::size_t>(rows));
    multipliers_.reserve(forces_.size());
    active_.reserve(forces_.size());
  }

  keepout::SolveStatus solve(const keepout::StepProblem& problem,
                             keepout::Solution& solution) noexcept override {
    const Eigen::Index rows = problem.rows.rows();
    if (!keepout::moves_a_point(problem)) return keepout::SolveStatus::invalid_input;
    if (rows > static_cast<Eigen::Index>(forces_.size()))
      return keepout::SolveStatus::over_capacity;
    u_ = problem.desired;
    std::fill_n(forces_.begin(), rows, 0.0);
    const double enough = 1e-14 * u_.norm();
    double largest = 1.0;
    int sweeps = 0;
    for (; largest > enough && sweeps < most_sweeps; ++sweeps) {
      largest = 0.0;
      for (Eigen::Index i = 0; i < rows; ++i) {
        const keepout::Vec3 row = problem.rows.row(i);
        double& force = forces_[static_cast<std::size_t>(i)];
        const double change =
            std::max(-force, (problem.bounds[i] - row.dot(u_)) / row.squaredNorm());
        force += change;
        u_ += change * row;
        largest = std::max(largest, std::abs(change) * row.norm());
      }
    }
    if (!(largest <= enough)) return keepout::SolveStatus::iteration_limit;  // or infeasible
    active_.clear();
    multipliers_.clear();
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(rows); ++i) {
      if (forces_[i] == 0.0) continue;
      active_.push_back(i);
      multipliers_.push_back(2.0 * forces_[i]);  // for |u - d|^2, not for half of it
    }
    solution = {{u_.data(), 3}, multipliers_, active_, sweeps};
    return keepout::SolveStatus::optimal;
  }

 private:
  static constexpr int most_sweeps = 100000;

  keepout::Vec3 u_ = keepout::Vec3::Zero();
  std::vector<double> forces_;  // (rows), >= 0: u = d + sum of forces_i row_i
  std::vector<double> multipliers_;
  std::vector<std::uint32_t> active_;
};

keepout::MotionConstraint guard_with(std::unique_ptr<keepout::Solver> solver,
                                     const std::shared_ptr<const keepout::Mesh>& mesh) {
  return {mesh,
          keepout::make_index("wide_bvh", mesh),
          keepout::make_activation("certified"),
          std::move(solver),
          {.radius = 2.0, .margin = 0.5}};
}

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s MESH\n", argv[0]);
    return 2;
  }
  const auto mesh = keepout::load_mesh(argv[1]).mesh;
  std::vector<keepout::RecordedProblem> problems;
  auto own = guard_with(
      std::make_unique<keepout::RecordingSolver>(std::make_unique<Hildreth>(), problems), mesh);
  auto ours = guard_with(keepout::make_solver("active_set"), mesh);

  // Straight down from above, then along the surface. The step checks the solution: if the solver
  // were wrong, the step would report it and not move.
  keepout::Vec3 tip(mesh->bounds().center());
  tip.z() = mesh->bounds().high.z() + 2.0;
  double apart = 0.0;  // [length]
  int held = 0, failed = 0;
  constexpr int cycles = 300;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    const keepout::Motion motion{.tip = tip, .desired = {0.05, 0.0, -0.1}};
    const keepout::Step step = own.step(motion);
    apart = std::max(apart, (step.motion - ours.step(motion).motion).norm());
    held += step.status != keepout::Status::free;
    failed += !step.ok();
    tip += step.motion;
  }

  Hildreth solver;
  solver.reserve(3, 1 << 14);
  keepout::Solution solution;
  double residual = 0.0;  // relative
  for (const keepout::RecordedProblem& problem : problems) {
    failed += solver.solve(problem.view(), solution) != keepout::SolveStatus::optimal;
    residual = std::max(residual, keepout::kkt_residual(problem.view(), solution).worst());
  }
  std::printf("held back in %d of %d cycles, %d failed; %.1e from active_set; ", held, cycles,
              failed, apart);
  std::printf("KKT residual %.1e in %zu problems\n", residual, problems.size());
  return 0;
} catch (const keepout::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
