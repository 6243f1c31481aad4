// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/solvers/active_set.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "active_set_method.h"
#include "point_method.h"

namespace keepout {

namespace {

bool shapes_agree(const StepProblem& problem) noexcept {
  const Eigen::Index n = problem.jacobian.cols();
  return n >= 1 && problem.desired.size() == problem.jacobian.rows() &&
         problem.bounds.size() == problem.rows.rows() &&
         (problem.rows.cols() == n || problem.rows.rows() == 0) &&
         (problem.planes.empty() ||
          (problem.jacobian.rows() == 3 &&
           problem.planes.size() <= static_cast<std::size_t>(problem.rows.rows()))) &&
         problem.planes.size() + problem.box.size() <=
             static_cast<std::size_t>(problem.rows.rows()) &&
         std::all_of(problem.box.begin(), problem.box.end(),
                     [n](std::uint8_t number) { return number < 2 * n; });
}

/// Returns true if J, d and damping are finite and in range.
bool cost_in_range(const StepProblem& problem) noexcept {
  // These comparisons are false for NaN.
  const auto in_range = [](double x) { return std::abs(x) <= active_set::largest; };
  const auto all_in_range = [&](const auto& numbers) {
    return std::all_of(numbers.data(), numbers.data() + numbers.size(), in_range);
  };
  return all_in_range(problem.jacobian) && all_in_range(problem.desired) &&
         in_range(problem.damping) && problem.damping >= 0;
}

}  // namespace

using active_set::Method;
using active_set::PointMethod;
using active_set::RowStore;

struct ActiveSet::Workspace {
  int variables = 0;
  int rows = 0;
  RowStore store;
  PointMethod point;       // three variables with J = I, as for a tip (moves_a_point)
  Method<3> space;         // three joints, and problems that PointMethod could not prove
  Method<6> six_joints;    // a pose, or most arms
  Method<7> seven_joints;  // a redundant arm
  Method<Eigen::Dynamic> any;
  std::vector<double> multipliers;
  std::vector<std::uint32_t> active;

  template <int N>
  SolveStatus solve(Method<N>& method, const StepProblem& problem, Solution& solution) noexcept {
    const SolveStatus status = method.solve(problem);
    solution.iterations += method.iterations();
    if (status == SolveStatus::optimal) write_solution(method, problem, solution);
    return status;
  }

  template <class M>
  void write_solution(const M& method, const StepProblem& problem, Solution& solution) noexcept {
    std::size_t count = 0;
    for (int i = 0; i < method.active_count(); ++i) {
      if (!(method.multiplier(i) > 0)) continue;
      std::size_t slot = count++;  // sorted by row
      const auto row = static_cast<std::uint32_t>(method.row(i));
      for (; slot > 0 && active[slot - 1] > row; --slot) {
        active[slot] = active[slot - 1];
        multipliers[slot] = multipliers[slot - 1];
      }
      active[slot] = row;
      multipliers[slot] = 2 * method.multiplier(i);  // the method halves the cost
    }
    const auto n = static_cast<std::size_t>(problem.jacobian.cols());
    solution.u = {method.u().data(), n};
    solution.multipliers = {multipliers.data(), count};
    solution.active = {active.data(), count};
  }
};

ActiveSet::ActiveSet() : work_(std::make_unique<Workspace>()) {}
ActiveSet::~ActiveSet() = default;

void ActiveSet::reserve(int variables, int rows) {
  Workspace& work = *work_;
  work.variables = std::max(variables, 0);
  work.rows = std::max(rows, 0);
  work.store.reserve(std::max(work.variables, 3), work.rows);
  work.point.reserve(work.rows);
  work.space.reserve(3, work.store);
  work.six_joints.reserve(6, work.store);
  work.seven_joints.reserve(7, work.store);
  work.any.reserve(work.variables, work.store);
  work.multipliers.resize(static_cast<std::size_t>(work.variables));
  work.active.resize(static_cast<std::size_t>(work.variables));
}

SolveStatus ActiveSet::solve(const StepProblem& problem, Solution& solution) noexcept {
  Workspace& work = *work_;
  solution = {};
  if (!shapes_agree(problem)) return SolveStatus::invalid_input;
  if (problem.jacobian.cols() > work.variables || problem.rows.rows() > work.rows) {
    return SolveStatus::over_capacity;
  }
  if (moves_a_point(problem)) {
    const bool solved = work.point.solve(problem);
    solution.iterations = work.point.iterations();
    if (solved) {
      work.write_solution(work.point, problem, solution);
      return SolveStatus::optimal;
    }
  }
  if (!cost_in_range(problem)) return SolveStatus::invalid_input;
  switch (problem.jacobian.cols()) {
    case 3:
      return work.solve(work.space, problem, solution);
    case 6:
      return work.solve(work.six_joints, problem, solution);
    case 7:
      return work.solve(work.seven_joints, problem, solution);
    default:
      return work.solve(work.any, problem, solution);
  }
}

}  // namespace keepout
