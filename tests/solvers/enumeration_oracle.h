// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "keepout/step/solver.h"

namespace keepout::test {

/// The minimiser by trying every set of active rows, in extended precision: exponential in m, and
/// too simple to be wrong. Nothing if no set of rows yields a feasible point.
std::optional<Eigen::VectorXd> enumerate_minimum(const StepProblem& problem);

}  // namespace keepout::test
