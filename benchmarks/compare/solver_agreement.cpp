// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <string_view>

#include "compare/agreement.h"
#include "keepout/solvers/active_set.h"
#include "keepout/solvers/kkt.h"
#include "keepout/solvers/registry.h"
#include "shared/progress.h"
#include "shared/timing.h"
#if KEEPOUT_HAS_NLOPT
#include "keepout/solvers/nlopt_solver.h"
#endif

namespace keepout::app {
namespace {

/// What the solver that all are compared to makes of a problem.
struct Expected {
  SolveStatus status;
  Eigen::VectorXd u;
};

Eigen::VectorXd vector_of(std::span<const double> values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// Room for the largest of the problems.
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
                                         const SolverComparison& comparison) {
  std::vector<RecordedProblem> problems =
      record_problems(mesh, rule, comparison.problems, comparison.seed);
  Random random(comparison.seed + 1);
  for (RecordedProblem& problem : problems) {
    constexpr double contradictory = 0.1;  // share of them
    if (random.uniform() < contradictory) contradict(problem, random);
  }
  return problems;
}

std::vector<Expected> references_of(const std::vector<RecordedProblem>& problems) {
  ActiveSet solver;
  reserve(solver, problems);
  std::vector<Expected> references;
  for (const RecordedProblem& problem : problems) {
    Solution solution;
    const SolveStatus status = solver.solve(problem.view(), solution);
    references.push_back({status, vector_of(solution.u)});
  }
  return references;
}

/// How far the tip ends from where the reference leads it, relative to the motion.
double difference(const RecordedProblem& problem, const Solution& solution,
                  const Expected& reference) {
  if (reference.status != SolveStatus::optimal) return 0.0;
  const double apart = (problem.jacobian * (vector_of(solution.u) - reference.u)).norm();
  const double reach = std::max((problem.jacobian * reference.u).norm(), problem.desired.norm());
  return apart == 0.0 ? 0.0 : apart / reach;
}

/// Returns what a library claimed and what was found; of our own solvers, the status.
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

/// Takes one answer down.
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

std::vector<SolverAgreement> compare_solvers(const std::shared_ptr<const Mesh>& mesh,
                                             const SolverComparison& comparison,
                                             const Stopped& stopped) {
  std::vector<SolverAgreement> rows;
  for (const std::string& rule : comparison.rules) {
    const std::vector<RecordedProblem> problems = problems_of(mesh, rule, comparison);
    const std::vector<Expected> references = references_of(problems);
    for (const std::string& name : comparison.solvers) {
      const SolverBackend& backend = solver_backends().named(name);
      const auto solver = backend.make();
      reserve(*solver, problems);
      const auto limit = comparison.most.find(name);
      const std::size_t count = limit == comparison.most.end()
                                    ? problems.size()
                                    : std::min(limit->second, problems.size());
      SolverAgreement row;
      row.solver = name;
      row.activation = rule;
      row.posed = problems.size();
      row.problems = count;
      std::vector<double> times;
      Progress progress(name + ", " + rule, count);
      for (std::size_t i = 0; i < count; ++i) {
        if (stopped()) return rows;
        const std::size_t at = i * problems.size() / count;
        const StepProblem problem = problems[at].view();
        Solution solution;
        const BenchClock::time_point start = BenchClock::now();
        const SolveStatus status = solver->solve(problem, solution);
        times.push_back(microseconds_since(start));
        ++row.outcomes[outcome(*solver, status)];
        judge(problems[at], references[at], status, solution, backend.accuracy, row);
        progress.advance();
      }
      const Timing timing = timing_of(times);
      row.median_us = timing.p50;
      row.p99_us = timing.p99.value_or(timing.max);
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace keepout::app
