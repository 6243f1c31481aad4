// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>

#include "compare/compare.h"
#include "keepout/activation/registry.h"
#include "keepout/error.h"
#include "keepout/fixtures/poses.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/query.h"
#include "keepout/solvers/active_set.h"
#include "keepout/solvers/kkt.h"
#include "keepout/solvers/registry.h"
#include "keepout/step/motion_constraint.h"
#if KEEPOUT_HAS_NLOPT
#include "keepout/solvers/nlopt_solver.h"
#endif

namespace keepout::app {
namespace {

/// Returns the Jacobian of a random arm, with revolute and prismatic joints.
TipJacobian::Matrix random_jacobian(Random& random) {
  TipJacobian::Matrix jacobian(3, 7);
  for (Eigen::Index c = 0; c < jacobian.cols(); ++c) {
    jacobian.col(c) = random.uniform(0.5, 2.0) * random.direction();
  }
  return jacobian;
}

/// The answer of the reference solver to a problem.
struct Expected {
  SolveStatus status;
  Eigen::VectorXd u;
};

Eigen::VectorXd vector_of(std::span<const double> values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// Reserves capacity for the largest of the problems.
template <class S>
void reserve(S& solver, const std::vector<RecordedProblem>& problems) {
  Eigen::Index variables = 0, rows = 0;
  for (const RecordedProblem& problem : problems) {
    variables = std::max(variables, problem.jacobian.cols());
    rows = std::max(rows, problem.rows.rows());
  }
  solver.reserve(static_cast<int>(variables), static_cast<int>(rows));
}

std::vector<RecordedProblem> problems_of(const std::shared_ptr<const Mesh>& mesh,
                                         const std::string& rule,
                                         const SolverComparison& comparison,
                                         const Stopped& stopped) {
  std::vector<RecordedProblem> problems =
      record_problems(mesh, rule, comparison.problems, comparison.seed, stopped);
  Random random(comparison.seed + 1);
  for (RecordedProblem& problem : problems) {
    constexpr double contradictory = 0.1;  // fraction of the problems
    if (random.uniform() < contradictory) contradict(problem, random);
  }
  return problems;
}

/// Returns the solutions of the problems; fewer after a stop.
std::vector<Expected> references_of(const std::vector<RecordedProblem>& problems,
                                    const Stopped& stopped) {
  ActiveSet solver;
  reserve(solver, problems);
  std::vector<Expected> references;
  for (const RecordedProblem& problem : problems) {
    if (stopped()) break;
    Solution solution;
    const SolveStatus status = solver.solve(problem.view(), solution);
    references.push_back({status, vector_of(solution.u)});
  }
  return references;
}

/// Returns the distance between the ends of both motions, relative to the motion.
double difference(const RecordedProblem& problem, const Solution& solution,
                  const Expected& reference) {
  if (reference.status != SolveStatus::optimal) return 0.0;
  const double apart = (problem.jacobian * (vector_of(solution.u) - reference.u)).norm();
  const double reach = std::max((problem.jacobian * reference.u).norm(), problem.desired.norm());
  return apart == 0.0 ? 0.0 : apart / reach;
}

/// Returns a library's claim and our finding; for our own solvers, the status.
std::string outcome(const Solver& solver, SolveStatus status) {
#if KEEPOUT_HAS_NLOPT
  if (const auto* nlopt = dynamic_cast<const NloptSolver*>(&solver)) {
    const NloptReport report = nlopt->last_report();
    return std::string(report.claim) + " -> " + std::string(name(report.finding));
  }
#else
  static_cast<void>(solver);
#endif
  return std::string(name(status));
}

/// Adds one answer to the row.
void judge(const RecordedProblem& problem, const Expected& reference, SolveStatus status,
           const Solution& solution, double accuracy, SolverAgreement& row) {
  switch (status) {
    case SolveStatus::optimal: {
      const double residual = kkt_residual(problem.view(), solution).worst();
      const double apart = difference(problem, solution, reference);
      const bool right = residual <= accuracy && apart <= accuracy;
      ++(right ? row.optimal : row.wrong);
      row.kkt_residual = std::max(row.kkt_residual, residual);
      row.step_difference = std::max(row.step_difference, apart);
      break;
    }
    case SolveStatus::infeasible:
      ++(reference.status == SolveStatus::optimal ? row.wrong : row.infeasible);
      break;
    default:
      ++row.gave_up;
  }
}

}  // namespace

std::vector<RecordedProblem> record_problems(const std::shared_ptr<const Mesh>& mesh,
                                             const std::string& rule, std::size_t count,
                                             std::uint64_t seed, const Stopped& stopped) {
  constexpr int approach = 10, strokes_at_once = 64, cycles = 30;
  constexpr double margin = 0.2;  // [mm]
  constexpr double radius = 5.0;  // [mm] as in the paper
  // A hundred times the number needed if every cycle in contact yields a problem.
  const std::size_t most_strokes = 100 * (count / (cycles - approach) + 1);
  std::vector<RecordedProblem> posed, kept;
  // Both guards record into one list: damped for joints, undamped for the tip.
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
      throw Error(
          "of " + std::to_string(count) + " problems in contact only " +
          std::to_string(kept.size()) + " were found, under " + rule +
          ", with motions of 0.05 to 0.2 mm half a millimeter from the mesh: is it in another "
          "unit, or too large or too narrow for them? Scale it to millimeters");
    }
    for (const Vec3& start : surface_points(*mesh, strokes_at_once, 0.5, random)) {
      if (stopped()) return kept;
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

std::vector<SolverAgreement> compare_solvers(const std::shared_ptr<const Mesh>& mesh,
                                             const SolverComparison& comparison,
                                             const Stopped& stopped) {
  std::vector<SolverAgreement> rows;
  for (const std::string& rule : comparison.rules) {
    std::vector<RecordedProblem> problems;
    std::vector<Expected> references;
    {
      const Progress progress("recording problems, " + rule, 1);
      problems = problems_of(mesh, rule, comparison, stopped);
      references = references_of(problems, stopped);
    }
    if (stopped()) return rows;
    for (const std::string& name : comparison.solvers) {
      const SolverBackend& backend = solver_backends().named(name);
      const auto solver = backend.make();
      reserve(*solver, problems);
      const auto limit = comparison.most.find(name);
      const std::size_t count = limit == comparison.most.end()
                                    ? problems.size()
                                    : std::min(limit->second, problems.size());
      SolverAgreement row{
          .solver = name, .activation = rule, .posed = problems.size(), .problems = count};
      Progress progress(name + ", " + rule, count);
      const auto at = [&](std::size_t i) { return i * problems.size() / count; };
      std::vector<StepProblem> views;
      for (std::size_t i = 0; i < count; ++i) views.push_back(problems[at(i)].view());
      Solution solution;
      const auto solve = [&](std::size_t i) { return solver->solve(views[i], solution); };
      const auto judge_one = [&](std::size_t i, SolveStatus status) {
        ++row.outcomes[outcome(*solver, status)];
        judge(problems[at(i)], references[at(i)], status, solution, backend.accuracy, row);
        solution = {};
      };
      const std::optional<Timing> timing = ask_all(count, progress, stopped, solve, judge_one);
      if (!timing) return rows;
      row.us = *timing;
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace keepout::app
