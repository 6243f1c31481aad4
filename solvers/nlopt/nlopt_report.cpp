// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/solvers/nlopt_solver.h"

namespace keepout {

std::string_view name(NloptClaim claim) noexcept {
  switch (claim) {
    case NloptClaim::not_asked:
      return "not asked";
    case NloptClaim::success:
      return "SUCCESS";
    case NloptClaim::stopval_reached:
      return "STOPVAL_REACHED";
    case NloptClaim::ftol_reached:
      return "FTOL_REACHED";
    case NloptClaim::xtol_reached:
      return "XTOL_REACHED";
    case NloptClaim::maxeval_reached:
      return "MAXEVAL_REACHED";
    case NloptClaim::maxtime_reached:
      return "MAXTIME_REACHED";
    case NloptClaim::failure:
      return "FAILURE";
    case NloptClaim::invalid_args:
      return "INVALID_ARGS";
    case NloptClaim::out_of_memory:
      return "OUT_OF_MEMORY";
    case NloptClaim::roundoff_limited:
      return "ROUNDOFF_LIMITED";
    case NloptClaim::forced_stop:
      return "FORCED_STOP";
    case NloptClaim::unknown:
      break;
  }
  return "unknown";
}

std::string_view name(NloptFinding finding) noexcept {
  switch (finding) {
    case NloptFinding::refused:
      return "refused";
    case NloptFinding::optimal:
      return "optimal";
    case NloptFinding::not_optimal:
      return "not optimal";
    case NloptFinding::not_feasible:
      return "not feasible";
    case NloptFinding::not_finite:
      return "not finite";
    case NloptFinding::infeasible:
      return "infeasible, proven";
  }
  return "unknown";
}

}  // namespace keepout
