// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "keepout/step/problem.h"

namespace keepout::nlopt {

/// The rows of a problem, ascending, without those that say nothing: rows of zeros, and of rows
/// that are parallel to rounding all but the tightest, of equals all but the first. NLopt's SLSQP
/// is known to give up where a row comes twice (its issues 400 and 567). What was dropped must be
/// checked all the same.
std::vector<std::uint32_t> without_parallels(const StepProblem& problem);

}  // namespace keepout::nlopt
