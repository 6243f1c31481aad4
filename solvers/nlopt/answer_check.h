// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "keepout/solvers/active_set.h"
#include "keepout/solvers/nlopt_solver.h"

namespace keepout::nlopt {

/// Judges a point that claims to be the optimum by the optimum that our own method has found.
class AnswerCheck {
 public:
  void reserve(int variables, int rows) { nearest_.reserve(variables, rows); }

  /// `optimal` if u, moved off the rows that it violates by the shortest way in task space,
  /// satisfies the rows, is as near as `accuracy` to what was given and to the best there, and
  /// meets the conditions of optimality to the accuracy with the multipliers of the best. Only then
  /// `answer` is written: its u is valid until the next call, and the rest as long as `best`.
  NloptFinding judge(const Eigen::VectorXd& u, const StepProblem& problem, const Solution& best,
                     double accuracy, Solution& answer);

 private:
  ActiveSet nearest_;
};

}  // namespace keepout::nlopt
