// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "keepout/solvers/nlopt_solver.h"
#include "nearest_point.h"

namespace keepout::nlopt {

/// What NLopt makes of a problem; nothing of it is checked.
struct Attempt {
  std::string_view claim;  // as NLopt spells it
  Eigen::VectorXd z;
  int evaluations = 0;
};

/// Runs a method of NLopt. Deterministic: limited in evaluations, never in time.
Attempt minimize(NloptMethod method, const NearestPoint& problem);

}  // namespace keepout::nlopt
