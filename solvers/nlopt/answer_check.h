// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "keepout/solvers/active_set.h"
#include "keepout/solvers/nlopt_solver.h"

namespace keepout::nlopt {

/// Compares a point that claims to be the optimum with the optimum that keepout's own method found.
class AnswerCheck {
 public:
  void reserve(int variables, int rows) { nearest_.reserve(variables, rows); }

  /// Judges u. First moves u to the rows that it violates, by the shortest way in task space.
  /// Returns `optimal` if the result satisfies the rows, is within `accuracy` of u and of `best`,
  /// and meets the conditions of optimality with the multipliers of `best`. Only then writes
  /// `answer`. Its u is valid until the next call, and the rest as long as `best`.
  NloptFinding judge(const Eigen::VectorXd& u, const StepProblem& problem, const Solution& best,
                     double accuracy, Solution& answer);

 private:
  ActiveSet nearest_;
};

}  // namespace keepout::nlopt
