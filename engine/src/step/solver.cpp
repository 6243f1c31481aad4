// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/solver.h"

namespace keepout {

std::string_view reason(SolveStatus status) noexcept {
  switch (status) {
    case SolveStatus::optimal:
      return "optimal: no motion that satisfies the constraints is better";
    case SolveStatus::infeasible:
      return "infeasible: the constraints contradict each other";
    case SolveStatus::ill_posed:
      return "ill-posed: the task leaves a direction of motion free; give it more rows or damping";
    case SolveStatus::invalid_input:
      return "invalid input: a number is not finite or out of range, or the shapes do not agree";
    case SolveStatus::over_capacity:
      return "over capacity: the problem has more variables or rows than were reserved";
    case SolveStatus::iteration_limit:
      return "iteration limit: the budget of work is spent, or rounding hides the answer";
  }
  return "unknown status";
}

}  // namespace keepout
