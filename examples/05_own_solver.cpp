// SPDX-License-Identifier: BSD-3-Clause
// A solver of your own: Hildreth's method (plugin/hildreth.h) in a motion constraint, checked
// against the conditions of Karush, Kuhn and Tucker and against active_set.
#include <algorithm>
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
#include "plugin/hildreth.h"

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
