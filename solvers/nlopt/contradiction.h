// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "keepout/step/problem.h"

namespace keepout::nlopt {

/// True if no u satisfies all rows, as ActiveSet means it: the weights y >= 0 of Farkas make
/// y^T A zero to rounding and y^T b positive beyond what rounding leaves of y^T A u for any u up to
/// 1000 reaches long. False proves nothing.
///
/// The weights come from min |A^T y|^2 + (b^T y / reach - 1)^2, which is zero just when there are
/// any: the second phase of the search for a feasible point is not needed to know that there is
/// none. Lawson, Hanson 1974, chapter 23, section 4. `rows`: to be looked at, none of zeros.
bool contradictory(const StepProblem& problem, std::span<const std::uint32_t> rows, double reach);

}  // namespace keepout::nlopt
