// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/step/solver.h"

namespace keepout {

std::string_view name(SolveStatus status) noexcept {
  return status == SolveStatus::optimal           ? "optimal"
         : status == SolveStatus::iteration_limit ? "iteration_limit"
                                                  : name(status_of(status));
}

Status status_of(SolveStatus status) noexcept {
  switch (status) {
    case SolveStatus::optimal:
      return Status::free;
    case SolveStatus::infeasible:
      return Status::infeasible;
    case SolveStatus::ill_posed:
      return Status::ill_posed;
    case SolveStatus::invalid_input:
      return Status::invalid_input;
    case SolveStatus::over_capacity:
      return Status::over_capacity;
    case SolveStatus::iteration_limit:
      break;
  }
  return Status::unsolved;
}

}  // namespace keepout
