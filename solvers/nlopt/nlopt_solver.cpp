// SPDX-License-Identifier: BSD-3-Clause
//
// The only file that uses NLopt.
#include "keepout/solvers/nlopt_solver.h"

#include <nlopt.h>

#include <array>
#include <memory>
#include <new>
#include <string>
#include <type_traits>

#include "answer_check.h"
#include "nearest_point.h"

namespace keepout {
namespace {

struct Destroy {
  void operator()(nlopt_opt opt) const noexcept { nlopt_destroy(opt); }
};
using Optimizer = std::unique_ptr<std::remove_pointer_t<nlopt_opt>, Destroy>;

/// The settings of a method: its tolerance of convergence, in multiples of the scale, and its limit
/// of evaluations.
struct Schedule {
  nlopt_algorithm algorithm;
  double x_tolerance;
  int most_evaluations;
};

Schedule schedule_of(NloptMethod method) noexcept {
  switch (method) {
    case NloptMethod::slsqp:
      return {NLOPT_LD_SLSQP, 1e-12, 100};
    case NloptMethod::cobyla:
      return {NLOPT_LN_COBYLA, 1e-9, 5000};
    case NloptMethod::mma:
      break;
  }
  return {NLOPT_LD_MMA, 1e-9, 300};
}

std::string_view claim_of(nlopt_result result) noexcept {
  const char* const text = nlopt_result_to_string(result);
  return text != nullptr ? text : "unknown";
}

/// The callbacks for NLopt. They count evaluations and check for NaN, because some loops of NLopt
/// do neither (its issues 28 and 350).
struct Callback {
  const nlopt::NearestPoint& problem;
  nlopt_opt optimizer;
  int most_evaluations;
  int evaluations = 0;

  static double cost(unsigned n, const double* x, double* gradient, void* data) {
    Callback& self = *static_cast<Callback*>(data);
    const Eigen::Map<const Eigen::VectorXd> z(x, n);
    if (++self.evaluations > self.most_evaluations || !z.allFinite()) {
      nlopt_force_stop(self.optimizer);
    }
    if (gradient != nullptr) Eigen::Map<Eigen::VectorXd>(gradient, n) = z;
    return 0.5 * z.squaredNorm();
  }

  static void violations(unsigned m, double* result, unsigned n, const double* x, double* gradient,
                         void* data) {
    const nlopt::NearestPoint& problem = static_cast<Callback*>(data)->problem;
    const Eigen::Map<const Eigen::VectorXd> z(x, n);
    Eigen::Map<Eigen::VectorXd> violations(result, m);  // no temporary: exceptions cannot pass
                                                        // through C
    violations = problem.bounds;
    violations.noalias() -= problem.normals * z;
    if (gradient != nullptr) {
      Eigen::Map<StepProblem::RowMatrix>(gradient, m, n) = -problem.normals;
    }
  }
};

/// Returns the start: rest, or a point inside all rows near it, if some projections on one violated
/// row after another find one. MMA rarely recovers from a start that violates a row, even by the
/// last digit.
Eigen::VectorXd start_of(const nlopt::NearestPoint& problem) {
  constexpr int most_projections = 64;
  constexpr double inside = 1e-3;
  Eigen::VectorXd z = problem.rest;
  for (int i = 0; i < most_projections && problem.bounds.size() > 0; ++i) {
    Eigen::Index row = 0;
    const double violation = (problem.bounds - problem.normals * z).maxCoeff(&row);
    if (!(violation > 0)) break;
    z += (violation + inside) * problem.normals.row(row).transpose();
  }
  return z;
}

/// An answer of NLopt, which is not checked yet.
struct Attempt {
  std::string_view claim;  // in NLopt's spelling
  Eigen::VectorXd z;
  int evaluations = 0;
};

/// Runs a method of NLopt. Deterministic, because the limit is in evaluations and not in time.
Attempt minimize(NloptMethod method, const nlopt::NearestPoint& problem) {
  const auto n = static_cast<unsigned>(problem.normals.cols());
  const auto m = static_cast<unsigned>(problem.normals.rows());
  const Schedule schedule = schedule_of(method);
  const Optimizer optimizer(nlopt_create(schedule.algorithm, n));
  Attempt attempt{.claim = {}, .z = start_of(problem)};
  if (!optimizer) {
    attempt.claim = claim_of(NLOPT_OUT_OF_MEMORY);
    return attempt;
  }
  nlopt_opt opt = optimizer.get();
  Callback callback{problem, opt, 2 * schedule.most_evaluations};
  // A row counts as satisfied a little early, which AnswerCheck allows for.
  const Eigen::VectorXd tolerances = Eigen::VectorXd::Constant(m, 1e-13);
  bool set = nlopt_set_min_objective(opt, Callback::cost, &callback) == NLOPT_SUCCESS &&
             nlopt_set_xtol_abs1(opt, schedule.x_tolerance) == NLOPT_SUCCESS &&
             nlopt_set_maxeval(opt, schedule.most_evaluations) == NLOPT_SUCCESS &&
             nlopt_set_initial_step1(opt, 0.5) == NLOPT_SUCCESS &&
             // A limit for the problem in the multipliers that MMA solves in each step. The default
             // of 100000 takes seconds.
             nlopt_set_param(opt, "dual_maxeval", 500) == NLOPT_SUCCESS;
  if (m > 0) {
    set = set && nlopt_add_inequality_mconstraint(opt, m, Callback::violations, &callback,
                                                  tolerances.data()) == NLOPT_SUCCESS;
  }
  if (!set) {
    attempt.claim = claim_of(NLOPT_INVALID_ARGS);
    return attempt;
  }
  double least = 0;
  attempt.claim = claim_of(nlopt_optimize(opt, attempt.z.data(), &least));
  attempt.evaluations = callback.evaluations;
  return attempt;
}

}  // namespace

struct NloptSolver::Workspace {
  explicit Workspace(NloptMethod which) : method(which) {}

  NloptMethod method;
  ActiveSet ours;
  nlopt::AnswerCheck check;
  NloptReport report;
};

NloptSolver::NloptSolver(NloptMethod method) : work_(std::make_unique<Workspace>(method)) {}
NloptSolver::~NloptSolver() = default;

void NloptSolver::reserve(int variables, int rows) {
  work_->ours.reserve(variables, rows);
  work_->check.reserve(variables, rows);
}

SolveStatus NloptSolver::solve(const StepProblem& problem, Solution& solution) noexcept {
  NloptReport& report = work_->report;
  report = {};
  solution = {};
  Solution best;
  const SolveStatus status = work_->ours.solve(problem, best);
  if (status != SolveStatus::optimal && status != SolveStatus::infeasible) return status;
  try {
    const nlopt::NearestPoint posed(problem);
    const Attempt attempt = minimize(work_->method, posed);
    report = {attempt.claim, NloptFinding::infeasible};
    if (status == SolveStatus::optimal) {
      report.finding = work_->check.judge(posed.variables_at(attempt.z), problem, best,
                                          accuracy(work_->method), solution);
    }
    solution.iterations = attempt.evaluations;
  } catch (const std::bad_alloc&) {
    report = {"OUT_OF_MEMORY", NloptFinding::refused};
    return SolveStatus::iteration_limit;
  }
  if (status == SolveStatus::infeasible) return status;
  return report.finding == NloptFinding::optimal ? status : SolveStatus::iteration_limit;
}

std::string NloptSolver::library() {
  int major = 0, minor = 0, fix = 0;
  nlopt_version(&major, &minor, &fix);
  return "NLopt " + std::to_string(major) + '.' + std::to_string(minor) + '.' + std::to_string(fix);
}

NloptReport NloptSolver::last_report() const noexcept { return work_->report; }

std::string_view name(NloptFinding finding) noexcept {
  constexpr std::array<std::string_view, 6> names{
      "refused", "optimal", "not optimal", "not feasible", "not finite", "infeasible, proven"};
  const auto at = static_cast<std::size_t>(finding);
  return at < names.size() ? names[at] : "unknown";
}

}  // namespace keepout
