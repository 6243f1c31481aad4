// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// The solvers on the problems of steps in contact, by their number of planes, and all that a step
// does with one: posing it, solving it, taking down the answer. A solver whose answers are not
// those of active_set is not timed.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "keepout/activation/registry.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/index/pd_tree.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/solvers/active_set.h"
#include "keepout/solvers/recording_solver.h"
#include "keepout/solvers/registry.h"
#include "keepout/step/find_motion.h"
#include "keepout/step/motion_constraint.h"

namespace keepout {
namespace {

using Problems = std::vector<RecordedProblem>;

constexpr int most_rows = 4000;

// So few planes are the first of a larger problem: hardly any step has exactly so many.
constexpr Eigen::Index few = 10;

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

/// The ones that have between m / 2 and 2 m planes and a solution: a hundred of them; without
/// planes or with few, so many of their first planes.
Problems problems_of(Eigen::Index m) {
  static const Problems all = record();
  ActiveSet exact;
  exact.reserve(3, static_cast<int>(all.back().rows.rows()));
  Problems some;
  for (RecordedProblem problem : all) {
    const Eigen::Index rows = problem.rows.rows();
    Solution solution;
    if (m <= few ? rows < m : 2 * rows < m || rows > 2 * m) continue;
    if (some.size() == 100) break;
    if (m <= few) {
      problem.rows.conservativeResize(m, Eigen::NoChange);
      problem.bounds.conservativeResize(m);
    }
    if (exact.solve(problem.view(), solution) == SolveStatus::optimal) some.push_back(problem);
  }
  return some;
}

/// The problem of a step, with the planes that it was posed with.
struct PosedStep {
  std::vector<HalfSpace> planes;
  Motion motion;
};

std::vector<PosedStep> steps_of(const Problems& problems) {
  std::vector<PosedStep> steps;
  for (const RecordedProblem& problem : problems) {
    PosedStep& step = steps.emplace_back();
    step.motion = {.tip = Vec3::Zero(), .desired = problem.desired};
    for (Eigen::Index i = 0; i < problem.rows.rows(); ++i) {
      step.planes.push_back({problem.rows.row(i), problem.bounds[i], static_cast<TriangleId>(i)});
    }
  }
  return steps;
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

/// A step's share of a solve: the planes of the step are given.
void pose_and_solve(benchmark::State& state, Eigen::Index m, int joints) {
  const std::vector<PosedStep> steps = steps_of(problems_of(m));
  if (steps.empty()) {
    state.SkipWithError("no such problems");
    return;
  }
  Random random(2);
  TipJacobian::Matrix jacobian(3, std::max(joints, 1));
  for (double& x : jacobian.reshaped()) x = random.uniform(-1.0, 1.0);
  StepProblem::RowMatrix limits(2 * joints, joints);
  limits << StepProblem::RowMatrix::Identity(joints, joints),
      -StepProblem::RowMatrix::Identity(joints, joints);
  const std::vector<double> bounds(static_cast<std::size_t>(2 * joints), -0.2);
  Workspace work({.triangles = 1, .planes = most_rows});
  ActiveSet solver;
  solver.reserve(7, most_rows + 14);
  std::size_t next = 0, posed = 0, optimal = 0;
  constexpr int repeats = 64;  // of each, so that its planes are in the cache as after a query
  for (auto _ : state) {
    const PosedStep& step = steps[next];
    next = (next + 1) % steps.size();
    work.planes.assign(step.planes);
    Motion motion = step.motion;
    if (joints > 0) {
      motion.jacobian = TipJacobian(jacobian);
      motion.rows = ExtraRows(limits.data(), bounds.data(), 2 * joints);
    }
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < repeats; ++i) {
      const StepProblem problem =
          work.pose(motion, motion.desired, joints > 0 ? 1e-4 : 0.0, PlaneRows::left_out);
      Solution solution;
      ++posed;
      if (solver.solve(problem, solution) != SolveStatus::optimal) continue;
      ++optimal;
      const std::optional<Vec3> tip = tip_motion(problem, solution, 1.0);
      if (joints > 0) {
        work.note(solution, 1.0);
      } else {
        work.note(solution, *tip);
      }
      benchmark::DoNotOptimize(work.increment().data());
    }
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    state.SetIterationTime(spent.count() / repeats);
  }
  state.counters["optimal_share"] = static_cast<double>(optimal) / static_cast<double>(posed);
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
  for (const Eigen::Index m : {0, 1, 3, 10, 100, 1000, 2000}) {
    const std::string name = "pose_and_solve/active_set/skull_1m/m=" + std::to_string(m);
    benchmark::RegisterBenchmark(name.c_str(), [m](benchmark::State& state) {
      pose_and_solve(state, m, 0);
    })->UseManualTime();
  }
  benchmark::RegisterBenchmark("pose_and_solve/active_set/skull_1m/joints=7/m=200",
                               [](benchmark::State& state) { pose_and_solve(state, 200, 7); })
      ->UseManualTime();
  return true;
}();

}  // namespace
}  // namespace keepout
