// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// The solvers on the problems of steps in contact, by their number of planes. A solver whose
// answers are not those of active_set is not timed.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "keepout/activation/registry.h"
#include "keepout/adapters/load_mesh.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/index/pd_tree.h"
#include "keepout/solvers/active_set.h"
#include "keepout/solvers/recording_solver.h"
#include "keepout/solvers/registry.h"
#include "keepout/step/motion_constraint.h"

namespace keepout {
namespace {

using Problems = std::vector<RecordedProblem>;

constexpr int most_rows = 2000;

/// What all faces within 5 mm of a tip on the CT skull pose to a push in any direction, in the
/// order of their number of planes.
Problems record() {
  Problems problems;
  const auto mesh = load_mesh(fixture_path("skull_1m")).mesh;
  for (const double radius : {0.5, 1.5, 5.0}) {
    MotionConstraint guard(
        mesh, std::make_unique<PdTree>(mesh), make_activation("all_faces", mesh),
        std::make_unique<RecordingSolver>(std::make_unique<ActiveSet>(), problems),
        {.radius = radius, .margin = 0.2});
    Random random(1);
    for (const Vec3& tip : surface_points(*mesh, 400, 0.4, random)) {
      guard.step({.tip = tip, .desired = 0.2 * random.direction()});
    }
  }
  std::ranges::stable_sort(problems, {}, [](const auto& p) { return p.rows.rows(); });
  return problems;
}

/// The ones that have between m / 2 and 2 m planes and a solution: a hundred of them.
Problems problems_of(Eigen::Index m) {
  static const Problems all = record();
  ActiveSet exact;
  exact.reserve(3, static_cast<int>(all.back().rows.rows()));
  Problems some;
  for (const RecordedProblem& problem : all) {
    const Eigen::Index rows = problem.rows.rows();
    Solution solution;
    if (2 * rows < m || rows > 2 * m || some.size() == 100) continue;
    if (exact.solve(problem.view(), solution) == SolveStatus::optimal) some.push_back(problem);
  }
  return some;
}

/// How many of the answers are those of active_set; the others, if any, are given up.
std::size_t agreeing(Solver& solver, const Problems& problems, double accuracy) {
  ActiveSet exact;
  exact.reserve(3, most_rows);
  std::size_t count = 0;
  for (const RecordedProblem& problem : problems) {
    Solution expected, got;
    exact.solve(problem.view(), expected);
    if (solver.solve(problem.view(), got) != SolveStatus::optimal) continue;
    double apart = 0.0;
    for (std::size_t i = 0; i < got.u.size(); ++i) {
      apart = std::max(apart, std::abs(got.u[i] - expected.u[i]));
    }
    if (apart > 2.0 * accuracy * problem.desired.norm()) return 0;
    ++count;
  }
  return count;
}

void solve(benchmark::State& state, const SolverBackend& backend, Eigen::Index m) {
  const Problems problems = problems_of(m);
  const auto solver = backend.make();
  solver->reserve(3, most_rows);
  const std::size_t optimal = agreeing(*solver, problems, backend.accuracy);
  if (optimal == 0) {
    state.SkipWithError("not the answers of active_set");
    return;
  }
  std::size_t next = 0;
  for (auto _ : state) {
    Solution solution;
    benchmark::DoNotOptimize(solver->solve(problems[next].view(), solution));
    next = (next + 1) % problems.size();
  }
  state.counters["optimal_share"] =
      static_cast<double>(optimal) / static_cast<double>(problems.size());
}

const bool registered = [] {
  for (const SolverBackend& backend : solver_backends()) {
    for (const Eigen::Index m : {10, 100, 1000}) {
      const std::string name =
          "solve/" + std::string(backend.name) + "/skull_1m/m=" + std::to_string(m);
      benchmark::RegisterBenchmark(name.c_str(), [&backend, m](benchmark::State& state) {
        solve(state, backend, m);
      })->Unit(benchmark::kMicrosecond);
    }
  }
  return true;
}();

}  // namespace
}  // namespace keepout
