// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "keepout/solvers/nlopt_solver.h"
#include "nearest_point.h"

namespace keepout::nlopt {

/// A point that claims to be the optimum, its last digits put right, and what is proven of it.
struct CheckedAnswer {
  NloptFinding finding = NloptFinding::not_optimal;
  Eigen::VectorXd u;
  std::vector<std::uint32_t> active;  // rows of the problem, ascending
  std::vector<double> multipliers;    // of these, as Solver defines them
};

/// Judges u without believing where it comes from. With weights >= 0 on rows near it, the cost of
/// every feasible point v is at least the dual value, and so in task space
///
///     |R (u - u*)|^2 <= |r|^2 + 2 sum weight_i slack_i,    r = (R u - c) - sum weight_i normal_i
///
/// holds for a feasible u: a sum of squares and products that are not negative, in which nothing
/// cancels. `optimal` if the right side is at most (accuracy x reach in task space)^2 and u
/// satisfies the rows. Rounding may leave u outside of some by 1e-11; the bound is then that of the
/// problem with these rows moved by as much.
CheckedAnswer check_answer(Eigen::VectorXd u, const StepProblem& problem, const Task& task,
                           const NearestPoint& posed, double accuracy);

}  // namespace keepout::nlopt
